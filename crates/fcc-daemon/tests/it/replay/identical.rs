//! A replay reproduces every bit.

use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use fcc_core::framework::State::{Engaged, Standby, Stopped};
use fcc_core::framework::{EventKind, LoopCommand, Message};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_flight::config::{Config, Then};
use fcc_guidance::Mode;

use super::assert_identical;
use super::flights::{Happenings, again, fly, records, rough};

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
fn every_kind_of_command() {
    let targets = [
        AutopilotCommand::Heading(FRAC_PI_2),
        AutopilotCommand::Altitude(1_000.0),
        AutopilotCommand::Airspeed(55.0),
        AutopilotCommand::Heading(f64::NAN),
        AutopilotCommand::AltimeterSetting(102_000.0),
        AutopilotCommand::Height(500.0),
        AutopilotCommand::PressureAltitude(900.0),
    ];
    let mut commands = vec![
        // Several in a tick, one to the loop among them.
        (400, LoopCommand::Controller(targets[0])),
        (400, LoopCommand::Controller(targets[1])),
        (600, LoopCommand::Controller(targets[4])),
        (700, LoopCommand::Controller(targets[6])),
        (800, LoopCommand::Disengage),
        (800, LoopCommand::Controller(targets[2])),
        (900, LoopCommand::Engage),
        (900, LoopCommand::Controller(targets[0])),
        (1_000, LoopCommand::Controller(targets[3])),
        (1_000, LoopCommand::Controller(targets[5])),
        // Refused: control is released in the same tick.
        (1_100, LoopCommand::Disengage),
        (1_100, LoopCommand::Engage),
        (1_600, LoopCommand::Stop),
    ];
    // More than a tick reads.
    commands.extend((0..40).map(|_| (1_200, LoopCommand::Controller(targets[2]))));
    let messages = fly(
        &rough(),
        &Happenings {
            commands,
            // The stop levels and trims for 10 s first.
            steps: 2_100,
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
            // One too short to matter, one that ends in time, one that does
            // not.
            silent: vec![300..=305, 400..=440, 600..=800],
            commands: vec![(486, LoopCommand::Engage), (900, LoopCommand::Engage)],
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

    // The stop came from the configuration, not from the recording.
    config.failsafe.hold_s = 2.0;
    let (run, identity) = again(&config, &messages);
    assert_eq!(run.unflown, None);
    assert_eq!(identity.first.unwrap().field, "state.phase");
}

/// Engaging begins the pattern, a commanded heading ends it and disengaging ends
/// guidance; each in the tick whose record has it.
#[test]
fn a_change_of_the_guidance_mode_is_an_event_of_its_tick() {
    let happenings = Happenings {
        commands: vec![
            (400, LoopCommand::Controller(AutopilotCommand::Heading(1.0))),
            (450, LoopCommand::Disengage),
        ],
        steps: 500,
        ..Happenings::default()
    };
    let messages = fly(&rough(), &happenings);
    let modes = messages.iter().filter_map(|message| match message {
        Message::Event(event) => match event.kind {
            EventKind::ModeChanged { .. } => Some((
                event.tick,
                event.kind.description::<Autopilot>().to_string(),
            )),
            _ => None,
        },
        Message::Tick(_) => None,
    });
    let records = records(&messages);
    let engaged = records.iter().find(|record| record.state == Engaged);
    let expected = [
        (
            engaged.unwrap().tick.number,
            "mode: timed-pattern, was none",
        ),
        (400, "mode: hold, was timed-pattern"),
        (450, "mode: none, was hold"),
    ];
    assert_eq!(
        modes.collect::<Vec<_>>(),
        expected.map(|(tick, text)| (tick, text.to_owned()))
    );
    let mut before = Mode::None;
    for record in &records {
        let mode = record.setpoints.guidance.mode;
        let is_event = expected.iter().any(|(tick, _)| *tick == record.tick.number);
        assert_eq!(mode != before, is_event, "tick {}", record.tick.number);
        before = mode;
    }
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
        // The first tick among them.
        late: vec![
            (1, ms(60)),
            (200, ms(10)),
            (300, ms(40)),
            (500, ms(180)),
            (700, ms(400)),
        ],
        commands: vec![(760, LoopCommand::Engage)],
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
