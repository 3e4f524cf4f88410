//! Commands between two programs on one machine.

use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use fcc_live::{
    Command, CommandError, Commander, Info, OutsideLimits, PendingCommand, Publisher, Text, Verdict,
};
use fcc_telemetry::Instance;

/// Long after a healthy machine has answered.
const PATIENCE: Duration = Duration::from_secs(10);

/// A name that no other test and no daemon uses.
fn instance(test: &str) -> Instance {
    format!("command-{}-{test}", std::process::id())
        .parse()
        .unwrap()
}

/// How the error begins where nobody publishes as this; how it ends depends on
/// whether other users' daemons are or were on the machine.
fn absent(instance: &Instance) -> String {
    format!("no fccd named '{instance}' runs here")
}

fn describe(mut publisher: Publisher) -> Publisher {
    publisher.describe(Info {
        software: Text::new("1.2.3"),
        ..Info::default()
    });
    publisher
}

fn started(instance: &Instance) -> Publisher {
    describe(Publisher::start_with_commands(instance, 2_048).unwrap())
}

fn next(publisher: &mut Publisher) -> PendingCommand {
    let deadline = Instant::now() + PATIENCE;
    loop {
        publisher.flush();
        if let Some(asked) = publisher.next_command() {
            return asked;
        }
        assert!(Instant::now() < deadline, "no command came");
        sleep(Duration::from_millis(2));
    }
}

fn heading() -> Command {
    Command::set([("heading_rad", 1.25)])
}

#[test]
fn a_command_arrives_and_its_answer_returns() {
    let instance = instance("answer");
    let mut publisher = started(&instance);
    let result = thread::scope(|scope| {
        let giver = scope.spawn(|| {
            let mut commander = Commander::open(&instance, "a test").unwrap();
            let first = commander.command(&heading());
            (first, commander.command(&Command::Engage))
        });
        let asked = next(&mut publisher);
        assert_eq!(asked.command, heading());
        assert_eq!(asked.sender, "a test");
        publisher.answer(asked.id, Verdict::CarriedOut { tick: 77 });
        let asked = next(&mut publisher);
        assert_eq!(asked.command, Command::Engage);
        publisher.answer(asked.id, Verdict::Refused("too slow".to_owned()));
        publisher.flush();
        giver.join().unwrap()
    });
    assert_eq!(result.0, Ok(77));
    assert_eq!(result.1, Err(CommandError::Refused("too slow".to_owned())));
}

#[test]
fn a_program_that_waits_is_answered_when_the_flight_ends() {
    let instance = instance("end");
    let mut publisher = started(&instance);
    let result = thread::scope(|scope| {
        let giver = scope.spawn(|| {
            Commander::open(&instance, "a test")
                .unwrap()
                .command(&Command::Disengage)
        });
        next(&mut publisher);
        drop(publisher);
        giver.join().unwrap()
    });
    // Answered by the daemon, or detected by its absence.
    assert!(
        matches!(
            &result,
            Err(CommandError::Refused(words)) if words == "the flight has ended"
        ) || matches!(
            &result,
            Err(CommandError::Unreachable(error)) if error.to_string().contains(&absent(&instance))
        ),
        "{result:?}"
    );
}

#[test]
fn a_value_outside_its_limits_returns_with_them() {
    let instance = instance("limits");
    let mut publisher = started(&instance);
    let outside = OutsideLimits {
        name: "altitude_m".to_owned(),
        value: f64::INFINITY,
        least: -500.0,
        most: 20_000.0,
    };
    let result = thread::scope(|scope| {
        let giver = scope.spawn(|| {
            let mut commander = Commander::open(&instance, "a test").unwrap();
            commander.command(&Command::set([("altitude_m", f64::INFINITY)]))
        });
        let asked = next(&mut publisher);
        publisher.answer(asked.id, Verdict::Outside(outside.clone()));
        publisher.flush();
        giver.join().unwrap()
    });
    let refused = result.unwrap_err();
    assert_eq!(refused, CommandError::InvalidCommand(outside.into()));
    let words = "refused: altitude is inf m: choose -500 to 20000 m";
    assert_eq!(refused.to_string(), words);
}

#[test]
fn a_daemon_without_commands_is_distinguished_from_none() {
    let instance = instance("none");
    let words = Commander::open(&instance, "a test")
        .unwrap_err()
        .to_string();
    assert!(words.contains(&absent(&instance)), "{words}");
    let _publisher = describe(Publisher::start(&instance, 2_048).unwrap());
    let words = Commander::open(&instance, "a test")
        .unwrap_err()
        .to_string();
    assert!(
        words.contains("version 1.2.3, accepts no commands"),
        "{words}"
    );
    assert!(words.contains("commands = false"), "{words}");
}

#[test]
fn a_daemon_with_another_layout_is_refused_with_a_reason() {
    let instance = instance("layout");
    let mut publisher = Publisher::start_with_commands(&instance, 2_048).unwrap();
    publisher.describe(Info {
        layout: u32::MAX,
        software: Text::new("9.0.0"),
        ..Info::default()
    });
    let words = Commander::open(&instance, "a test")
        .unwrap_err()
        .to_string();
    assert!(words.contains("version 9.0.0"), "{words}");
}
