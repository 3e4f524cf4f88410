//! How long each part of the check takes.

use std::time::Duration;

/// Durations, in full or shortened.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Waits {
    /// A pause.
    pub(crate) pause: Duration,
    /// An open map, open settings.
    pub(crate) window: Duration,
    /// A replay.
    pub(crate) replay: Duration,
    /// How long the aircraft is watched after each of these, and while it is
    /// flown with another rate of time or a deflected joystick.
    pub(crate) watch: Duration,
    /// How long the altitude is watched after the altimeter was set.
    pub(crate) altimeter: Duration,
    /// How long a steady state is averaged.
    pub(crate) average: Duration,
    /// The highest number of the generic lights that are switched.
    pub(crate) lights: u8,
    /// The pattern: how long it holds first.
    pub(crate) hold_s: f64,
    /// The pattern: legs, their duration, turn and climb.
    pub(crate) legs: u8,
    pub(crate) leg_s: f64,
    pub(crate) turn_deg: f64,
    pub(crate) climb_ft: f64,
}

const fn seconds(s: u64) -> Duration {
    Duration::from_secs(s)
}

/// Those of the check that judges, and the thesis' pattern.
pub(crate) const FULL: Waits = Waits {
    pause: seconds(20),
    window: seconds(20),
    replay: seconds(10),
    watch: seconds(5),
    altimeter: seconds(20),
    average: seconds(3),
    lights: 127,
    hold_s: 20.0,
    legs: 2,
    leg_s: 20.0,
    turn_deg: 90.0,
    climb_ft: 150.0,
};

/// For a quick look and for tests.
pub(crate) const SHORT: Waits = Waits {
    pause: seconds(1),
    window: seconds(1),
    replay: seconds(1),
    watch: Duration::from_millis(1_200),
    altimeter: seconds(3),
    average: Duration::from_millis(800),
    lights: 7,
    hold_s: 2.0,
    legs: 1,
    leg_s: 12.0,
    turn_deg: 20.0,
    climb_ft: 15.0,
};
