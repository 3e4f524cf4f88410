//! A recording flown again gives the same outputs to the last bit, and what
//! is not the same is found.
#![cfg(test)]

mod files;
mod flights;

use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use fcc_core::flight::Order as Command;
use fcc_core::framework::State::{self, Engaged, Standby, Stopped};
use fcc_core::framework::{EventKind, Message, Order, Reading, Time};
use fcc_daemon::config::{Config, CourseSection, Then};
use fcc_daemon::replay::{Deviation, Replay, run};
use fcc_telemetry::FlightMessage;

use flights::{Happenings, again, fly, records, rough};

/// The outputs of a tick: 4 surfaces, 6 set points, the step's length, state,
/// blockers, faults, and whether they were sent.
const OUTPUTS: u64 = 15;

/// Asserts that a recording flown again is the same in every bit, and gives
/// the states it went through.
fn assert_identical(config: &Config, messages: &[FlightMessage]) -> Vec<State> {
    let (run, identity) = again(config, messages);
    let records = records(messages);
    assert_eq!(run.unflown, None);
    assert_eq!(run.ticks, records.len() as u64);
    assert_eq!(identity.outputs, run.ticks * OUTPUTS);
    assert_eq!(identity.differing, 0, "{}", identity.to_text());
    let mut states: Vec<_> = records.iter().map(|record| record.state.state()).collect();
    states.dedup();
    states
}

#[test]
fn ten_minutes_in_gusts_noise_and_delay() {
    let messages = fly(
        &rough(),
        &Happenings {
            steps: 24_000,
            ..Happenings::default()
        },
    );
    let states = assert_identical(&rough(), &messages);
    assert_eq!(states, [Standby, Engaged]);
}

#[test]
fn every_way_of_being_ordered_about() {
    let commands = [
        Command::Heading(FRAC_PI_2),
        Command::Altitude(1_000.0),
        Command::Airspeed(55.0),
        Command::Heading(f64::NAN),
    ];
    let mut orders = vec![
        // Several in a tick, one to the loop among them.
        (400, Order::Controller(commands[0])),
        (400, Order::Controller(commands[1])),
        (800, Order::Disengage),
        (800, Order::Controller(commands[2])),
        (900, Order::Engage),
        (900, Order::Controller(commands[0])),
        (1_000, Order::Controller(commands[3])),
        // Refused: control is let go in the same tick.
        (1_100, Order::Disengage),
        (1_100, Order::Engage),
        (1_600, Order::Stop),
    ];
    // More than a tick reads.
    orders.extend((0..40).map(|_| (1_200, Order::Controller(commands[2]))));
    let messages = fly(
        &rough(),
        &Happenings {
            orders,
            steps: 2_000,
            ..Happenings::default()
        },
    );
    let states = assert_identical(&rough(), &messages);
    assert_eq!(
        states,
        [
            Standby, Engaged, Standby, Engaged, Standby, Engaged, Stopped
        ]
    );
}

#[test]
fn failsafe_and_back() {
    let mut config = rough();
    config.failsafe.hold_s = 2.0;
    let messages = fly(
        &config,
        &Happenings {
            // One too short to matter, one that ends in time, one that does not.
            silent: vec![300..=305, 400..=440, 600..=800],
            orders: vec![(450, Order::Engage), (900, Order::Engage)],
            steps: 1_200,
            ..Happenings::default()
        },
    );
    let states = assert_identical(&config, &messages);
    let phases: Vec<_> = states.iter().map(ToString::to_string).collect();
    assert_eq!(
        phases,
        [
            "standby", "engaged", "failsafe", "engaged", "failsafe", "standby", "engaged"
        ]
    );
}

#[test]
fn failsafe_that_ends_the_loop() {
    let mut config = rough();
    config.failsafe.hold_s = 1.0;
    config.failsafe.then = Then::Stop;
    let happenings = Happenings {
        silent: vec![400..=800],
        steps: 1_200,
        ..Happenings::default()
    };
    let messages = fly(&config, &happenings);
    let states = assert_identical(&config, &messages);
    assert_eq!(states.last(), Some(&Stopped));

    // The stop came from the configuration and not from the recording.
    config.failsafe.hold_s = 2.0;
    let (run, identity) = again(&config, &messages);
    assert_eq!(run.unflown, None);
    assert_eq!(identity.first.unwrap().field, "state");
}

#[test]
fn the_stop_flag_in_flight() {
    let happenings = Happenings {
        stop_before: Some(500),
        steps: 600,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let states = assert_identical(&rough(), &messages);
    assert_eq!(records(&messages).len(), 500);
    assert_eq!(states, [Standby, Engaged, Stopped]);
}

#[test]
fn late_and_missed_ticks() {
    let ms = Duration::from_millis;
    let happenings = Happenings {
        // The very first among them.
        late: vec![
            (1, ms(60)),
            (200, ms(10)),
            (300, ms(40)),
            (500, ms(180)),
            (700, ms(400)),
        ],
        orders: vec![(760, Order::Engage)],
        steps: 1_500,
        ..Happenings::default()
    };
    for rate_hz in [40.0, 60.0, 137.0] {
        let mut config = rough();
        config.tick.rate_hz = rate_hz;
        let messages = fly(&config, &happenings);
        assert_identical(&config, &messages);
        let missed: u64 = records(&messages).iter().map(|r| r.tick.missed).sum();
        assert!(missed > 20, "{missed}");
    }
}

#[test]
fn a_configuration_written_out_and_read_again_is_the_same_to_the_last_bit() {
    let mut config = rough();
    config.autopilot.heading.roll_gain_per_s /= 3.0;
    config.autopilot.altitude.capture_g *= 1.0 + f64::EPSILON;
    config.autopilot.airspeed.throttle_per_g = 0.1 + 0.2;
    config.autopilot.envelope.max_bank_deg = 1e2_f64.sqrt() * 3.3;
    config.tick.rate_hz = 1e3 / 7.0;
    let text = toml::to_string(&config).unwrap();
    let read = Config::parse(&text, "attached").unwrap();
    assert_eq!(read.autopilot_config(), config.autopilot_config());
    assert_eq!(read.tick.period(), config.tick.period());

    let happenings = Happenings {
        steps: 2_000,
        ..Happenings::default()
    };
    let messages = fly(&config, &happenings);
    assert_identical(&read, &messages);
}

/// One of the gains of a configuration.
type Gain = fn(&mut Config) -> &mut f64;

/// The gain with the last bit of its mantissa flipped.
pub(crate) fn flipped(gain: f64) -> f64 {
    f64::from_bits(gain.to_bits() ^ 1)
}

#[test]
fn one_flipped_bit_in_a_gain_is_found() {
    let happenings = Happenings {
        steps: 4_000,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let engaged = records(&messages)
        .iter()
        .find(|record| record.state == Engaged)
        .map(|record| record.tick.number)
        .unwrap();

    let flips: [(&str, Gain); 4] = [
        ("outputs.aileron", |c| {
            &mut c.autopilot.heading.roll_rate_gain
        }),
        ("outputs.elevator", |c| {
            &mut c.autopilot.altitude.pitch_rate_gain
        }),
        ("outputs.throttle", |c| {
            &mut c.autopilot.airspeed.throttle_per_g
        }),
        ("outputs.rudder", |c| &mut c.autopilot.heading.yaw_damping),
    ];
    for (output, gain) in flips {
        let mut config = rough();
        let gain = gain(&mut config);
        *gain = flipped(*gain);
        let (run, identity) = again(&config, &messages);
        assert_eq!(run.unflown, None);
        let first = identity.first.clone().unwrap();
        assert_eq!(first.field, output);
        // Nothing is commanded before; and a last bit shows within a second.
        assert!(
            (engaged..engaged + 40).contains(&first.tick),
            "{output}: {} after {engaged}",
            first.tick
        );
        assert_ne!(first.recorded_bits, first.again_bits);
        let field = identity.fields.iter().find(|f| f.field == output).unwrap();
        assert_eq!(field.first_tick, first.tick);
        // The first difference is a last bit's worth. Where a limiter is met
        // it may grow from there: the integral stands still on one side of it.
        let number = |bits: &str| {
            let bits = bits.trim_start_matches("0x");
            f64::from_bits(u64::from_str_radix(bits, 16).unwrap())
        };
        let difference = (number(&first.recorded_bits) - number(&first.again_bits)).abs();
        assert!(difference > 0.0 && difference < 1e-9, "{difference}");
        assert!(field.largest.unwrap() >= difference);
    }
}

#[test]
fn one_flipped_bit_in_a_recorded_output_is_the_only_difference() {
    let happenings = Happenings {
        steps: 500,
        ..Happenings::default()
    };
    let mut messages = fly(&rough(), &happenings);
    let nan = f64::from_bits(0x7ff8_0000_0000_0001);
    for message in &mut messages {
        if let Message::Tick(record) = message {
            match record.tick.number {
                400 => record.outputs.rudder = flipped(record.outputs.rudder),
                // Equal by ==, and not by its bits; in standby it is 0.
                10 => record.setpoints.roll_rad = -0.0,
                20 => record.outputs.throttle = nan,
                _ => {}
            }
        }
    }
    let (_, identity) = again(&rough(), &messages);
    assert_eq!(identity.differing, 3);
    let first = identity.first.unwrap();
    assert_eq!((first.tick, first.time_ms), (10, 225));
    assert_eq!(first.field, "setpoints.roll_rad");
    assert_eq!(first.recorded_bits, "0x8000000000000000");
    assert_eq!(first.again_bits, "0x0000000000000000");
    assert_eq!(
        (first.recorded.as_str(), first.again.as_str()),
        ("-0.0", "0.0")
    );
    let throttle = identity
        .fields
        .iter()
        .find(|field| field.field == "outputs.throttle")
        .unwrap();
    assert_eq!((throttle.differing, throttle.largest), (1, None));
}

#[test]
fn another_rate_is_found_in_the_first_tick() {
    let happenings = Happenings {
        steps: 100,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let mut config = rough();
    config.tick.rate_hz = 41.0;
    let first = again(&config, &messages).1.first.unwrap();
    assert_eq!((first.tick, first.field), (1, "tick.dt_s"));
}

#[test]
fn a_gap_ends_what_can_be_flown_again() {
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
        orders: vec![(300, Order::Disengage)],
        steps: 400,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let told = |message: &FlightMessage| match message {
        Message::Event(event) => match event.kind {
            EventKind::Ordered(_) => {
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
    assert!(run.unflown.unwrap().why.contains("may be orders"));
}

#[test]
fn a_recording_that_begins_in_flight_is_refused_and_chained_ones_are_not() {
    let happenings = Happenings {
        orders: vec![(700, Order::Controller(Command::Heading(1.0)))],
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

    // The same twice, or in the wrong sequence.
    let (run, _) = again(&rough(), &[one, one].concat());
    assert_eq!(run.ticks, records(one).len() as u64);
    assert!(run.unflown.unwrap().why.contains("another flight"));
}

#[test]
fn a_loop_that_stops_before_the_recorded_one_says_so() {
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
    assert_eq!((first.tick, first.field), (stopped, "state"));
    assert_eq!(first.again, "stopped");
}

#[test]
fn the_recorded_configuration_does_not_deviate() {
    let messages = fly(
        &rough(),
        &Happenings {
            steps: 2_000,
            ..Happenings::default()
        },
    );
    let deviation = deviation(&rough(), &messages);
    let sent = records(&messages).iter().filter(|r| r.sent).count();
    assert_eq!(deviation.compared, sent as u64);
    assert!(sent > 1_900);
    for quantity in deviation.quantities {
        assert_eq!((quantity.differing, quantity.largest), (0, 0.0));
    }
}

fn deviation(config: &Config, messages: &[FlightMessage]) -> Deviation {
    let mut deviation = Deviation::default();
    let replay = Replay::new(config).unwrap();
    run(replay, messages.iter().copied(), |recorded, other| {
        deviation.take(recorded, other);
    });
    deviation
}

/// A course that turns the other way: after the hold of 20 s its set point is
/// 180° from the recorded one (90° right, 90° left), and a second leg later
/// 360°, which is the same heading.
#[test]
fn another_course_deviates_by_what_the_course_says() {
    let mut config = rough();
    let happenings = Happenings {
        steps: 80 + 40 * 39,
        ..Happenings::default()
    };
    let messages = fly(&config, &happenings);
    let CourseSection::TimedPattern { turn_deg, .. } = &mut config.course else {
        panic!("the default is a pattern");
    };
    assert_eq!(*turn_deg, 90.0);
    *turn_deg = -90.0;
    let other = deviation(&config, &messages);
    let of = |name: &str| other.quantities.iter().find(|q| q.name == name).unwrap();
    let heading = of("heading set point");
    assert!((heading.largest.abs() - 180.0).abs() < 1e-9);
    let at_s = heading.largest_at_s.unwrap();
    assert!((at_s - 21.975).abs() < 0.03, "{at_s}");
    // 19 of 39 s at 180°: rms 180 sqrt(19/39).
    let expected = 180.0 * (19.0_f64 / 39.0).sqrt();
    assert!((heading.rms - expected).abs() < 1.0, "{}", heading.rms);
    assert_eq!(of("altitude set point").differing, 0);
    assert!(of("bank set point").largest.abs() > 30.0);
    assert!(of("aileron").differing > 600);
    let text = other.to_text();
    assert!(text.contains("did not react"), "{text}");
}

/// What is in a file may be anything.
#[test]
fn nonsense_is_flown_without_a_panic() {
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
        // The first whose time goes back is not flown.
        assert_eq!(run.ticks, 150);
        assert!(identity.outputs == 150 * OUTPUTS && !identity.to_text().is_empty());
        deviation(&rough(), &messages).to_text();
    }
}
