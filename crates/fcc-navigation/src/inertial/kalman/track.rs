//! Which sensors are used and which are refused, and since when.

use crate::inertial::ObservationKind;
use fcc_core::framework::Time;

/// The history of one sensor.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Track {
    /// When the filter last looked at it.
    pub(super) tried: Time,
    /// When it was last believed.
    pub(super) used: Time,
    /// Since when it has been refused without interruption.
    pub(super) refused_since: Time,
}

impl Track {
    /// The time since the filter last looked at it; at most a second.
    pub(super) fn since_tried_s(&self, now: Time) -> f64 {
        seconds(now, self.tried).min(1.0)
    }

    pub(super) fn since_used_s(&self, now: Time) -> f64 {
        seconds(now, self.used)
    }

    /// For how long it has been refused.
    pub(super) fn refused_s(&self, now: Time) -> f64 {
        if self.refused_since.is_never() {
            0.0
        } else {
            seconds(now, self.refused_since)
        }
    }

    pub(super) fn judged(&mut self, now: Time, accepted: bool) {
        self.tried = now;
        if accepted {
            self.used = now;
            self.refused_since = Time::NEVER;
        } else if self.refused_since.is_never() {
            self.refused_since = now;
        }
    }
}

fn seconds(now: Time, earlier: Time) -> f64 {
    now.since(earlier).as_secs_f64()
}

/// Those of all sensors, and of what is known without one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tracks {
    pub(super) field: Track,
    pub(super) barometer: Track,
    pub(super) airspeed: Track,
    /// When an airspeed sensor last showed anything, however little.
    pub(super) airspeed_heard: Time,
    pub(super) position: Track,
    pub(super) velocity: Track,
    /// The velocity of a hand.
    pub(super) unaided: Track,
    /// Standing still.
    pub(super) rest: Track,
}

impl Tracks {
    pub(super) fn of(&mut self, kind: ObservationKind) -> &mut Track {
        match kind {
            ObservationKind::MagneticField => &mut self.field,
            ObservationKind::StaticPressure => &mut self.barometer,
            ObservationKind::DifferentialPressure | ObservationKind::Airspeed => &mut self.airspeed,
            ObservationKind::Position => &mut self.position,
            ObservationKind::Velocity => &mut self.velocity,
            ObservationKind::Rates | ObservationKind::SpecificForce => &mut self.rest,
        }
    }
}
