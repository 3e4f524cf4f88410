//! Commands in shared memory: any bytes; what reaches the loop is within its
//! limits, and each command is answered once. Answers: any bytes.
//!
//! The first byte chooses the state of the loop; 1352 bytes are a command, the
//! last of which may be missing.
#![no_main]

use fcc_core::flight::ALTIMETER_SETTINGS_PA;
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_core::framework::{Cause, Event, EventKind, LoopCommand, State, Time};
use fcc_live::{PendingCommand, SentCommands, Verdict, read_answer, read_request};
use fcc_telemetry::units::AVIATION;

const COMMAND_BYTES: usize = 1_352;
const TICK: u64 = 7;

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((state, rest)) = input.split_first() else {
        return;
    };
    let state = [State::Standby, State::Engaged, State::Failsafe(Cause::InvalidOutput), State::Stopped]
        [usize::from(state % 4)];
    let limits = vec![
        ("airspeed_mps", Ok(30.0..=60.0)),
        ("height_m", Err("no field is known")),
    ];
    let mut commands = SentCommands::<Autopilot>::new(limits);
    assert_eq!(commands.verdict(1, state), None);
    let mut waiting = Vec::new();
    let mut sent = Vec::new();
    for (id, bytes) in (0..).zip(rest.chunks(COMMAND_BYTES).take(8)) {
        if let Verdict::Outside(outside) = read_answer(bytes) {
            let _ = (outside.text_in(AVIATION), outside.to_string());
        }
        let Ok(command) = read_request(bytes) else {
            continue;
        };
        let sender = "fuzz".to_owned();
        match commands.send(PendingCommand { id, sender, command }, |command| {
            sent.push(command);
            Ok(())
        }) {
            None => waiting.push(id),
            Some((answered, verdict)) => {
                assert_eq!(answered, id);
                assert!(!matches!(verdict, Verdict::CarriedOut { .. }));
            }
        }
    }
    for command in sent {
        if let LoopCommand::Controller(command) = command {
            assert_permitted(command);
        }
        commands.event(&Event {
            tick: TICK,
            time: Time::NEVER,
            kind: EventKind::CommandReceived(command),
        });
    }
    while let Some((id, _)) = commands.verdict(TICK, state) {
        let at = waiting.iter().position(|waiting| *waiting == id);
        waiting.swap_remove(at.expect("it waits"));
    }
    // A stop is answered when the loop has stopped.
    while let Some((id, _)) = commands.verdict(TICK + 1, State::Stopped) {
        let at = waiting.iter().position(|waiting| *waiting == id);
        waiting.swap_remove(at.expect("it waits"));
    }
    assert!(waiting.is_empty(), "{waiting:?} are not answered");
});

/// Within the limits of the documentation, of which one two-hundredth is
/// rounding.
fn assert_permitted(command: AutopilotCommand) {
    let (value, least, most) = match command {
        AutopilotCommand::Airspeed(value) => (value, 30.0, 60.0),
        AutopilotCommand::Heading(value) => (value, -std::f64::consts::TAU, std::f64::consts::TAU),
        AutopilotCommand::AltimeterSetting(value) => {
            (value, *ALTIMETER_SETTINGS_PA.start(), *ALTIMETER_SETTINGS_PA.end())
        }
        AutopilotCommand::Altitude(value) | AutopilotCommand::PressureAltitude(value) => {
            (value, -500.0, 20_000.0)
        }
        AutopilotCommand::Heartbeat(value) => (value, 0.0, 3_600.0),
        AutopilotCommand::Plan(item) => (f64::from(item), 0.0, 1_000.0),
        AutopilotCommand::Pause
        | AutopilotCommand::GoTo(_)
        | AutopilotCommand::ReturnHome
        | AutopilotCommand::GoAround
        | AutopilotCommand::Land => return,
        other => panic!("{other:?} has no name"),
    };
    assert!((least - 0.006..=most + 0.006).contains(&value), "{command:?}");
}
