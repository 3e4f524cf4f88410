//! Differences are found to the last bit, and the deviation of another
//! configuration is measured.

use fcc_core::blocks::wrap_two_pi;
use fcc_core::framework::Message;
use fcc_core::framework::State::Engaged;
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::{Config, GuidanceSection};
use fcc_replay::Identity;
use fcc_telemetry::FlightRecord;

use super::flights::{Happenings, again, fly, records, rough};
use super::{deviation, flipped};

/// An earlier version recorded 342.7° after almost two turns as 702.7°.
#[test]
fn a_recorded_heading_that_continues_through_full_turns_is_the_same() {
    let compared = |recorded_deg: f64, again_deg: f64| {
        let [mut recorded, mut again] = [FlightRecord::default(); 2];
        recorded.estimate.heading_rad = recorded_deg.to_radians();
        again.estimate.heading_rad = wrap_two_pi(again_deg.to_radians());
        let mut identity = Identity::of::<Autopilot>();
        identity.take(&recorded, &again);
        identity.is_identical()
    };
    assert!(compared(702.7, 702.7));
    assert!(compared(-1.0, -1.0));
    assert!(compared(90.0, 90.0));
    assert!(!compared(702.7, 342.8));
}

/// One of the gains of a configuration.
type Gain = fn(&mut Config) -> &mut f64;

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
        // Nothing is commanded before; and a difference in the last bit shows
        // within two seconds.
        assert!(
            (engaged..engaged + 80).contains(&first.tick),
            "{output}: {} after {engaged}",
            first.tick
        );
        assert_ne!(first.recorded_bits, first.again_bits);
        let field = identity.fields.iter().find(|f| f.field == output).unwrap();
        assert_eq!(field.first_tick, first.tick);
        // The first difference is in the last bit. It may grow at a limiter:
        // the integral stops on one side of it.
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
    assert_eq!((first.tick, first.field.as_str()), (1, "tick.dt_s"));
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

/// A pattern that turns the other way: after the hold of 20 s its set point is
/// 180° from the recorded one (90° right, 90° left), and a second leg later
/// 360°, which is the same heading.
#[test]
fn another_pattern_deviates_by_what_the_pattern_says() {
    let mut config = rough();
    let happenings = Happenings {
        steps: 80 + 40 * 39,
        ..Happenings::default()
    };
    let messages = fly(&config, &happenings);
    let GuidanceSection::TimedPattern { turn_deg, .. } = &mut config.guidance else {
        panic!("the default is a pattern");
    };
    assert_eq!(*turn_deg, 90.0);
    *turn_deg = -90.0;
    let other = deviation(&config, &messages);
    let of = |name: &str| other.quantities.iter().find(|q| q.name == name).unwrap();
    let heading = of("desired heading");
    assert!((heading.largest.abs() - 180.0).abs() < 1e-9);
    let at_s = heading.largest_at_s.unwrap();
    assert!((at_s - 22.0).abs() < 0.03, "{at_s}");
    // 19 of 39 s at 180°: rms 180 sqrt(19/39).
    let expected = 180.0 * (19.0_f64 / 39.0).sqrt();
    assert!((heading.rms - expected).abs() < 1.0, "{}", heading.rms);
    assert_eq!(of("desired altitude").differing, 0);
    assert!(of("desired roll").largest.abs() > 30.0);
    assert!(of("commanded aileron").differing > 600);
    let text = other.to_text();
    assert!(text.contains("did not react"), "{text}");
    // What nobody commands is not compared.
    assert!(
        of("commanded flaps").rms.is_nan() && !text.contains("NaN"),
        "{text}"
    );
}
