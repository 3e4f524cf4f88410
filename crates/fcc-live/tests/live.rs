//! A publisher and its watchers, as two programs on one machine.
//!
//! A process of its own: handlers of signals are of the whole process.
#![cfg(test)]

use std::thread::sleep;
use std::time::{Duration, Instant};

use fcc_core::framework::{EventKind, Record, State, Tick, Time};
use fcc_live::{
    Event, EventCode, Info, LAYOUT, MAX_WATCHERS, PublishError, Publisher, RecorderState,
    RecorderStatus, Text, WatchError, Watcher,
};
use fcc_telemetry::{FlightEvent, Instance, RunFolder};

/// Long after a healthy machine has answered.
const PATIENCE: Duration = Duration::from_secs(10);

/// A name that no other test and no daemon uses.
fn instance(test: &str) -> Instance {
    format!("test-{}-{test}", std::process::id())
        .parse()
        .unwrap()
}

fn started(instance: &Instance) -> Publisher {
    let mut publisher = Publisher::start(instance, 2_048).unwrap();
    publisher.describe(Info {
        software: Text::new("1.2.3"),
        rate_hz: 40.0,
        ..Info::default()
    });
    publisher
}

fn record<M: Default, E: Default, S: Default, O: Default>(number: u64) -> Record<M, E, S, O> {
    Record {
        tick: Tick {
            number,
            scheduled: Time::from_nanos(number as i64 * 1_000_000),
            woke: Time::from_nanos(number as i64 * 1_000_000 + 5_000),
            ..Tick::default()
        },
        ..Record::default()
    }
}

fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let deadline = Instant::now() + PATIENCE;
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(Instant::now() < deadline, "not received: {what}");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn each_record_arrives_once_and_in_order() {
    let instance = instance("command");
    let mut publisher = started(&instance);
    let mut watcher = Watcher::open(&instance).unwrap();
    assert_eq!(watcher.info().software.as_str(), "1.2.3");
    assert_eq!(watcher.info().rate_hz, 40.0);
    for number in 0..500 {
        publisher.record(&record(number));
    }
    publisher.flush();
    for number in 0..500 {
        let found = wait_for("a record", || watcher.next_record().unwrap());
        assert_eq!(found, record(number));
    }
    assert_eq!(watcher.next_record().unwrap(), None);
}

#[test]
fn a_late_watcher_gets_the_newest_record_the_status_and_past_events() {
    let instance = instance("late");
    let mut publisher = started(&instance);
    let event = FlightEvent {
        tick: 3,
        time: Time::from_nanos(3_005_000),
        kind: EventKind::StateChanged {
            from: State::Standby,
            to: State::Engaged,
        },
    };
    publisher.event(Event::new(&event, "standby -> engaged"));
    publisher.recorder(RecorderStatus {
        state: RecorderState::Recording,
        recorded: 8,
        name: Text::new("flight.mcap"),
        ..RecorderStatus::default()
    });
    for number in 0..10 {
        publisher.record(&record(number));
    }
    publisher.flush();
    // The status after all of these were published.
    let mut first = Watcher::open(&instance).unwrap();
    wait_for("a status of ten ticks", || {
        first
            .latest_status()
            .unwrap()
            .filter(|status| status.ticks == 10)
    });

    let mut watcher = Watcher::open(&instance).unwrap();
    let newest = wait_for("the newest record", || watcher.latest().unwrap());
    assert_eq!(newest.tick.number, 9);
    let event = wait_for("the event", || watcher.next_event().unwrap());
    assert_eq!(event.code, EventCode::StateChanged as u32);
    assert_eq!((event.tick, event.values), (3, [0, 1, 0]));
    assert_eq!(event.text.as_str(), "standby -> engaged");
    let status = wait_for("a status", || watcher.latest_status().unwrap());
    assert_eq!((status.ticks, status.lateness_max_ns), (10, 5_000));
    assert_eq!(status.recorder(), RecorderState::Recording);
    assert_eq!(status.recording.as_str(), "flight.mcap");
}

/// Each record is published or counted, even if they come faster than they can
/// be published.
#[test]
fn dropped_records_are_counted() {
    let instance = instance("flood");
    let mut publisher = started(&instance);
    let mut watcher = Watcher::open(&instance).unwrap();
    let given = 50_000;
    for number in 0..given {
        publisher.record(&record(number));
    }
    let mut came = 0;
    let mut read = |watcher: &mut Watcher| {
        while watcher.next_record().unwrap().is_some() {
            came += 1;
        }
        came
    };
    // Its ring has room for 2,048, and its thread polls every 10 ms; a watcher's
    // queue has room for 1,024.
    let status = wait_for("a status of all records", || {
        publisher.flush();
        read(&mut watcher);
        watcher.latest_status().unwrap()
    });
    assert_eq!(status.ticks, given);
    let published = given - status.not_published;
    assert!((2_048..given).contains(&published), "{status:?}");
    assert!(read(&mut watcher) >= 1_024);
}

#[test]
fn a_watcher_notices_the_end_and_the_next_flight() {
    let instance = instance("end");
    let publisher = started(&instance);
    let mut watcher = Watcher::open(&instance).unwrap();
    assert!(watcher.is_alive());
    drop(publisher);
    wait_for("the end", || (!watcher.is_alive()).then_some(()));
    // The first watcher still has the services open.
    let words = Watcher::open(&instance).unwrap_err().to_string();
    assert!(
        words.contains(&format!("no fccd named '{instance}' runs here")),
        "{words}"
    );
    let _publisher = started(&instance);
    assert!(Watcher::open(&instance).unwrap().is_alive());
}

#[test]
fn without_a_daemon_the_error_says_what_to_do() {
    let words = Watcher::open(&instance("nobody")).unwrap_err().to_string();
    assert!(words.contains("no fccd named 'test-"), "{words}");
    assert!(words.contains("--instance test-"), "{words}");
}

#[test]
fn without_a_daemon_of_this_name_those_that_run_are_named() {
    let runs = instance("runs");
    let _publisher = started(&runs);
    Watcher::open(&runs).unwrap();
    let words = Watcher::open(&instance("other")).unwrap_err().to_string();
    let (_, running) = words.split_once("; running here: ").unwrap();
    assert!(
        running.split(", ").any(|name| name == runs.to_string()),
        "{words}"
    );
}

/// The start of a flight can say a lot about its plan.
#[test]
fn a_long_event_arrives_whole() {
    let instance = instance("long");
    let mut publisher = started(&instance);
    let words = "an event of 900 letters ".repeat(38)[..900].to_owned();
    publisher.event(Event::remark(0, 0, &words));
    publisher.flush();
    let mut watcher = Watcher::open(&instance).unwrap();
    let event = wait_for("the event", || watcher.next_event().unwrap());
    assert_eq!(event.text.as_str(), words);
}

#[test]
fn a_daemon_with_another_layout_is_refused_with_a_reason() {
    let instance = instance("layout");
    let mut publisher = Publisher::start(&instance, 2_048).unwrap();
    publisher.describe(Info {
        layout: LAYOUT + 1,
        software: Text::new("9.0.0"),
        ..Info::default()
    });
    let error = Watcher::open(&instance).unwrap_err();
    let words = error.to_string();
    assert!(words.contains("version 9.0.0"), "{words}");
    assert!(
        words.contains(&format!("layout {}", LAYOUT + 1))
            && words.contains(&format!("layout {LAYOUT}:")),
        "{words}"
    );
}

#[test]
fn a_name_can_be_used_by_one_daemon() {
    let instance = instance("taken");
    let _first = started(&instance);
    assert_eq!(
        Publisher::start(&instance, 2_048).unwrap_err(),
        PublishError::NameTaken(instance)
    );
}

#[test]
fn one_watcher_too_many_is_refused_without_effect_on_others() {
    let instance = instance("many");
    let mut publisher = started(&instance);
    let mut watchers: Vec<Watcher> = (0..MAX_WATCHERS)
        .map(|_| Watcher::open(&instance).unwrap())
        .collect();
    assert_eq!(
        Watcher::open(&instance).unwrap_err(),
        WatchError::TooMany(instance.clone())
    );
    for number in 0..100 {
        publisher.record(&record(number));
    }
    publisher.flush();
    for watcher in &mut watchers {
        for number in 0..100 {
            let found = wait_for("a record", || watcher.next_record().unwrap());
            assert_eq!(found.tick.number, number);
        }
    }
    // The freed place is available to another.
    watchers.pop();
    wait_for("room", || Watcher::open(&instance).ok());
}

#[test]
fn a_watcher_that_never_reads_delays_nothing() {
    let instance = instance("hang");
    let mut publisher = started(&instance);
    let mut hung = Watcher::open(&instance).unwrap();
    let mut watcher = Watcher::open(&instance).unwrap();
    // Three times a watcher's queue.
    for number in 0..3_072 {
        publisher.record(&record(number));
        if number % 256 == 255 {
            publisher.flush();
            wait_for("a record", || {
                watcher
                    .latest()
                    .unwrap()
                    .filter(|record| record.tick.number == number)
            });
        }
    }
    // The oldest were overwritten by the newest.
    let found = wait_for("a record", || hung.next_record().unwrap());
    assert_eq!(found.tick.number, 3_072 - 1_024);
}

#[test]
fn the_signal_handlers_of_the_process_are_unchanged() {
    let caught = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status
            .lines()
            .find(|line| line.starts_with("SigCgt"))
            .unwrap();
        line.to_owned()
    };
    let before = caught();
    let instance = instance("signals");
    let _publisher = started(&instance);
    let _watcher = Watcher::open(&instance).unwrap();
    assert_eq!(caught(), before);
}

/// As `rm -r` of a run folder does: of this instance alone, since others may
/// fly.
#[test]
fn it_is_said_that_nothing_is_published_after_its_files_were_removed() {
    let instance = instance("removed");
    let mut publisher = started(&instance);
    publisher.record(&record(1));
    wait_for("the first", || Watcher::open(&instance).ok());
    let folders = RunFolder::all_of_this_user();
    let mut folders = folders
        .iter()
        .map(|all| all.path(&format!("live-{instance}")));
    let folder = folders.find(|path| path.exists()).unwrap();
    std::fs::remove_dir_all(folder).unwrap();
    let words = wait_for("the remark", || publisher.poll());
    assert!(words.contains("live telemetry has failed"), "{words}");
    publisher.record(&record(2));
}
