//! What follows from an airspeed that is doubted: it is reported, of several
//! sensors left out, and the limits keep a distance that its uncertainty needs.

use core::fmt;

use super::{Autopilot, flags};
use crate::flight::Measurements;
use crate::flight::control::Envelope;
use crate::flight::guidance::Mode;
use crate::flight::navigation::{Doubt, DoubtReason};
use crate::framework::{Flags, Notice, Time};

/// The numbers of notices: one for each reason, with the sensor's number in the
/// lowest bits.
const REASONS: [(u8, DoubtReason, &str); 4] = [
    (
        0x40,
        DoubtReason::BlockedTube,
        "it rises and falls with the altitude: the pitot tube may be blocked",
    ),
    (
        0x60,
        DoubtReason::TooHigh,
        "it is higher than forces and motion allow",
    ),
    (
        0x80,
        DoubtReason::TooLow,
        "it is lower than forces and motion allow",
    ),
    (
        0xa0,
        DoubtReason::BlockedStatic,
        "it changes against the height, and the altitude stands: the static port may be blocked",
    ),
];
const SENSORS: u8 = 0x1f;

/// Limits move inwards by this many standard deviations of the airspeed, at most
/// by this share of the range between them.
const KEPT_SDS: f64 = 1.0;
const MOST_SHARE: f64 = 0.15;

/// Writes the notice of a doubt.
pub(super) fn write(kind: u8, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let known = REASONS
        .iter()
        .find(|(number, ..)| *number == kind & !SENSORS);
    match known {
        Some((_, _, reason)) => write!(
            f,
            "airspeed of sensor {} is doubted: {reason}; flying on without it",
            (kind & SENSORS) + 1
        ),
        None => f.write_str("an unknown notice"),
    }
}

impl Autopilot {
    /// The throttle that drives the aircraft: as measured, or as it was put.
    pub(super) fn note_throttle(&mut self, now: Time) {
        let is_engaged = self.guidance.mode() != Mode::None;
        let measured = self.accepted.surfaces.fresh(now, self.config.max_age);
        let throttle = match measured {
            Some(surfaces) => Some(surfaces.throttle),
            None if is_engaged => Some(self.last.throttle),
            None => None,
        };
        self.navigation.flown_with(throttle, is_engaged);
    }

    /// Prepares the notice of a doubt that has begun, or whose reason is another.
    pub(super) fn note_doubt(&mut self, before: Option<Doubt>) {
        let now = self.navigation.airspeed_doubt();
        self.doubt_notice = now
            .filter(|doubt| before != Some(*doubt))
            .and_then(|doubt| {
                let known = REASONS
                    .iter()
                    .find(|(_, reason, _)| *reason == doubt.reason);
                known.map(|(number, ..)| Notice {
                    kind: number | doubt.source.min(SENSORS),
                    ..Notice::default()
                })
            });
    }

    /// The conditions that airspeed and altitude are doubted.
    pub(super) fn doubted(&self) -> Flags {
        Flags::NONE
            .with(
                flags::DOUBTED_AIRSPEED,
                self.navigation.airspeed_doubt().is_some(),
            )
            .with(
                flags::DOUBTED_ALTITUDE,
                self.navigation.altitude_doubt().is_some(),
            )
    }

    /// Whether a sensor's airspeed may be used beside others'.
    pub(super) fn permits_airspeed(&self, measurements: &Measurements) -> bool {
        let airspeed = measurements.airspeed_mps;
        airspeed.is_never() || self.navigation.permits_airspeed(airspeed.value)
    }

    /// The envelope, with the distance that the airspeed's uncertainty needs.
    pub(super) fn envelope(&self) -> Envelope {
        let envelope = self.config.envelope;
        let range_mps = envelope.max_airspeed_mps - envelope.min_airspeed_mps;
        let by_mps = (KEPT_SDS * self.navigation.estimate().airspeed_uncertainty_mps)
            .min(MOST_SHARE * range_mps);
        Envelope {
            min_airspeed_mps: envelope.min_airspeed_mps + by_mps,
            max_airspeed_mps: envelope.max_airspeed_mps - by_mps,
            ..envelope
        }
    }

    /// A commanded airspeed, inside of that envelope while the airspeed is not a
    /// sensor's.
    pub(super) fn flyable_airspeed_mps(&self, commanded_mps: f64) -> f64 {
        if self.navigation.estimate().airspeed_uncertainty_mps > 0.0 {
            self.envelope().allowed_airspeed(commanded_mps)
        } else {
            commanded_mps
        }
    }
}
