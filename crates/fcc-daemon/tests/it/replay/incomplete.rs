//! Missing or invalid messages end a replay with a reason.

use fcc_core::framework::{EventKind, LoopCommand, Message, Reading, Time};
use fcc_fixed_wing::AutopilotCommand;
use fcc_flight::config::Then;
use fcc_telemetry::FlightMessage;

use super::flights::{Happenings, again, fly, records, rough};
use super::{OUTPUTS, assert_identical, deviation};

#[test]
fn a_gap_ends_the_replay() {
    let happenings = Happenings {
        steps: 1_000,
        ..Happenings::default()
    };
    let mut messages = fly(&rough(), &happenings);
    messages.retain(
        |message| !matches!(message, Message::Tick(record) if (600..=609).contains(&record.tick.number)),
    );
    let (run, identity) = again(&rough(), &messages);
    assert_eq!((run.ticks, identity.differing), (599, 0));
    let unflown = run.unflown.unwrap();
    assert_eq!(
        (unflown.ticks, unflown.first, unflown.last),
        (391, Some(610), Some(1_000))
    );
    assert!(unflown.why.contains("600 to 609"), "{}", unflown.why);
}

#[test]
fn missing_events_end_it_too() {
    let happenings = Happenings {
        commands: vec![(300, LoopCommand::Disengage)],
        steps: 400,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let told = |message: &FlightMessage| match message {
        Message::Event(event) => match event.kind {
            EventKind::CommandReceived(_) => {
                let kind = EventKind::EventsDropped {
                    count: 1,
                    first: event.tick,
                    last: event.tick,
                };
                Message::Event(fcc_telemetry::FlightEvent { kind, ..*event })
            }
            _ => *message,
        },
        Message::Tick(_) => *message,
    };
    let messages: Vec<_> = messages.iter().map(told).collect();
    let (run, identity) = again(&rough(), &messages);
    assert_eq!((run.ticks, identity.differing), (299, 0));
    assert!(run.unflown.unwrap().why.contains("may be commands"));
}

#[test]
fn a_recording_that_begins_in_flight_is_refused_and_chained_ones_are_not() {
    let happenings = Happenings {
        commands: vec![(700, LoopCommand::Controller(AutopilotCommand::Heading(1.0)))],
        steps: 1_000,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let (one, two) = messages.split_at(650);
    let (run, identity) = again(&rough(), two);
    assert_eq!((run.ticks, identity.outputs), (0, 0));
    let unflown = run.unflown.unwrap();
    assert!(unflown.why.contains("recordings before it"), "{unflown:?}");
    assert_eq!(unflown.ticks, records(two).len() as u64);

    assert_identical(&rough(), &[one, two].concat());

    // The same twice, or in the wrong order.
    let (run, _) = again(&rough(), &[one, one].concat());
    assert_eq!(run.ticks, records(one).len() as u64);
    assert!(run.unflown.unwrap().why.contains("another run"));
}

#[test]
fn a_loop_that_stops_before_the_recorded_one_is_reported() {
    let happenings = Happenings {
        silent: vec![400..=500],
        steps: 800,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let mut config = rough();
    config.failsafe.hold_s = 0.5;
    config.failsafe.then = Then::Stop;
    let (run, identity) = again(&config, &messages);
    let unflown = run.unflown.unwrap();
    assert!(unflown.why.contains("stopped before"), "{}", unflown.why);
    let stopped = unflown.first.unwrap() - 1;
    assert_eq!(run.ticks, stopped);
    let first = identity.first.unwrap();
    assert_eq!((first.tick, first.field.as_str()), (stopped, "state.phase"));
    assert_eq!(first.again, "stopped");
}

/// A file may contain anything.
#[test]
fn invalid_messages_are_replayed_without_a_panic() {
    let happenings = Happenings {
        steps: 200,
        ..Happenings::default()
    };
    let flown = fly(&rough(), &happenings);
    let times = [i64::MIN, i64::MIN + 1, -1, 0, i64::MAX];
    let numbers = [f64::NAN, f64::INFINITY, -f64::MAX, f64::MIN_POSITIVE];
    for (case, time) in times.iter().enumerate() {
        let mut messages = flown.clone();
        for message in &mut messages {
            let Message::Tick(record) = message else {
                continue;
            };
            if record.tick.number < 100 {
                continue;
            }
            let number = numbers[(case + record.tick.number as usize) % numbers.len()];
            record.tick.woke = Time::from_nanos(*time);
            record.measurements.plant.value.time_s = number;
            record.measurements.altitude_m = Reading::new(number, Time::from_nanos(*time));
            record.measurements.attitude.value.roll_rad = number;
            record.measurements.surfaces.value.elevator = number;
            if record.tick.number == 150 {
                record.tick.scheduled = Time::from_nanos(i64::MAX);
            }
        }
        let (run, identity) = again(&rough(), &messages);
        // The first whose time goes back is not replayed.
        assert_eq!(run.ticks, 150);
        assert!(identity.outputs == 150 * OUTPUTS && !identity.to_text().is_empty());
        deviation(&rough(), &messages).to_text();
    }
}
