//! What follows from an airspeed or another quantity that is doubted: it is reported, of several
//! sensors left out, and the limits keep a distance that its uncertainty needs.

use core::fmt;

use super::Autopilot;
use crate::control::Envelope;
use fcc_core::framework::{Notice, Time};
use fcc_guidance::Mode;
use fcc_navigation::{Doubt, DoubtReason};

/// The numbers of notices: one for each reason, with the sensor's number in the
/// lowest bits.
const REASONS: [(u8, DoubtReason, &str); 4] = [
    (
        0x20,
        DoubtReason::Ground,
        "the speed over the ground contradicts it",
    ),
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
];
const SENSORS: u8 = 0x1f;

/// Limits move inwards by this many standard deviations of the airspeed, at most
/// by this share of the range between them.
const KEPT_SDS: f64 = 1.0;
const MOST_SHARE: f64 = 0.15;
/// The slowest glide over a stalling speed that was found in flight: 65 over 53 kt are
/// a Cessna 172's best.
const LEAST_GLIDE: f64 = 1.23;

/// Writes the notice of a doubt.
pub(super) fn write(kind: u8, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let known = REASONS
        .iter()
        .find(|(number, ..)| *number == kind & !SENSORS);
    match known {
        Some((_, _, reason)) => write!(
            f,
            "airspeed of sensor {} is excluded: {reason}; flying on without it",
            (kind & SENSORS) + 1
        ),
        None => f.write_str("an unknown notice"),
    }
}

impl Autopilot {
    /// The throttle that drives the aircraft: as measured, or as it was put.
    pub(super) fn note_throttle(&mut self, now: Time) {
        let is_engaged = self.guidance.mode.mode() != Mode::None;
        let measured = self
            .intake
            .accepted
            .surfaces
            .fresh(now, self.config.max_age);
        let throttle = match measured {
            Some(surfaces) => Some(surfaces.throttle),
            None if is_engaged => Some(self.loops.last.throttle),
            None => None,
        };
        // On the wheels forces and motion say nothing of the air.
        let is_flying = is_engaged && !self.is_on_wheels();
        self.estimator
            .navigation
            .flown_with(throttle, is_flying, self.is_on_runway());
        if let Some(airspeed_mps) = self.guidance.on_runway.flies_at_mps.take() {
            self.estimator.navigation.leave_airspeed(airspeed_mps);
        }
    }

    /// Reports a doubt that has begun, or whose reason is another.
    pub(super) fn note_doubt(&mut self, before: Option<Doubt>) {
        let now = self.estimator.navigation.airspeed_doubt();
        let begun = now.filter(|doubt| before != Some(*doubt));
        let event = begun.and_then(|doubt| {
            let known = REASONS
                .iter()
                .find(|(_, reason, _)| *reason == doubt.reason);
            known.map(|(number, ..)| Notice {
                kind: number | doubt.source.min(SENSORS),
                ..Notice::default()
            })
        });
        if let Some(event) = event {
            self.journal.add(event);
        }
    }

    /// The envelope, with the distance that the airspeed's uncertainty needs, and with the
    /// stalling speed that was found in this flight. Its lowest airspeed permits the
    /// bank that the turn needs: one that is limited for want of speed would
    /// otherwise stay limited.
    pub(super) fn envelope(&self) -> Envelope {
        let (envelope, estimate) = (self.config.envelope, self.estimator.estimate());
        let range_mps = envelope.max_airspeed_mps - envelope.min_airspeed_mps;
        let by_mps = (KEPT_SDS * estimate.airspeed_uncertainty_mps).min(MOST_SHARE * range_mps);
        let found_mps = self.loops.recovery.found_stall_mps();
        let envelope = Envelope {
            min_airspeed_mps: envelope.min_airspeed_mps + by_mps,
            max_airspeed_mps: envelope.max_airspeed_mps - by_mps,
            stall_airspeed_mps: envelope.stall_airspeed_mps.max(found_mps),
            best_glide_airspeed_mps: envelope
                .best_glide_airspeed_mps
                .max(LEAST_GLIDE * found_mps),
            ..envelope
        };
        let bank_rad = self.loops.heading.needed_bank_rad();
        let floor_mps = envelope.floor_in_turn_mps(bank_rad, estimate.gust_load);
        let middle_mps = 0.5 * (floor_mps + envelope.max_airspeed_mps);
        Envelope {
            min_airspeed_mps: floor_mps.min(middle_mps),
            ..envelope
        }
    }

    /// A commanded airspeed, inside of that envelope while the airspeed is not a
    /// sensor's.
    pub(super) fn flyable_airspeed_mps(&self, commanded_mps: f64) -> f64 {
        if self.estimator.estimate().airspeed_uncertainty_mps > 0.0 {
            self.envelope().allowed_airspeed(commanded_mps)
        } else {
            commanded_mps
        }
    }
}
