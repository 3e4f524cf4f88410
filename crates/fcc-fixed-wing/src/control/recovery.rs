//! Recovery from an upset.
//!
//! In the order of FAA-H-8083-3C, chapter 5 (upset recovery): unload, roll the
//! shorter way to wings level, power by the speed, then pull to the horizon
//! within load, angle of attack and speed. A spin gets power idle, ailerons
//! neutral, full rudder against it, then elevator forward (the same handbook,
//! chapter 5, spin recovery; Bowman, NASA TN D-6575, 1971). Neither heading nor
//! altitude is followed meanwhile.

use libm::{sin, sqrt};

use super::load::LoadLoop;
use super::upset::{Motion, UpsetDetector};
use super::{AltitudeLoop, Envelope, HeadingLoop, Schedule};
use fcc_core::blocks::{RateLimit, limit, limit_abs};
use fcc_core::flight::Surfaces;
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::Estimate;

/// Wings level enough for the full load: bank, rad (25°), and roll rate, rad/s
/// (30 °/s).
const LEVEL_RAD: f64 = 0.436;
const ROLLS_RADPS: f64 = 0.524;
/// Roll rate per bank, 1/s, and the largest, rad/s: beyond what ailerons of
/// light aircraft give, so that they are fully used.
const ROLL_GAIN_PER_S: f64 = 2.6;
const MAX_ROLL_RATE_RADPS: f64 = 2.6;
/// How far ahead the roll is extrapolated for the shorter way, s: the time in
/// which it is stopped.
const ROLL_STOPS_S: f64 = 0.2;
/// Beyond this bank the side once chosen is kept, rad (160°): rolled on through inverted by
/// an aileron that ran away, the other side is the shorter way.
const KEEPS_SIDE_RAD: f64 = 2.79;
/// The ailerons' share while the wing is stalled: they drop the wing they raise.
const STALLED_AILERON: f64 = 0.3;
/// How far ahead the airspeed is extrapolated for the throttle, s.
const SPEED_AHEAD_S: f64 = 2.0;
/// How long the rudder acts in a spin before the elevator, s.
const RUDDER_FIRST_S: f64 = 0.3;
/// The elevator in a spin; the load at which the wing is unloaded enough, g, and the
/// rate at which the nose drops fast enough, rad/s (20 °/s): there it is neutral
/// again, or the load would turn negative.
const SPIN_ELEVATOR: f64 = -0.7;
const SPIN_UNLOADED: f64 = 0.3;
const SPIN_NOSE_DROPS_RADPS: f64 = 0.349;
/// How fast the throttle moves, 1/s.
const THROTTLE_RATE_PER_S: f64 = 1.0;
/// A stalled wing has less lift than the largest, at which it stalled: it flies this
/// many times faster. Each stall raises the stalling speed at least as much. With the
/// least load for which this is computed, g.
const STALLED_RATIO: f64 = 1.1;
const LEAST_LOAD: f64 = 0.5;
/// The time constant with which the trims of undisturbed flight are followed, s.
const TRIM_TAU_S: f64 = 2.0;

/// What a recovery step depends on, besides the estimate.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RecoveryInputs<'a> {
    pub(crate) envelope: &'a Envelope,
    pub(crate) schedule: Schedule,
    pub(crate) heading: &'a HeadingLoop,
    pub(crate) altitude: &'a AltitudeLoop,
    /// Whether the surfaces followed the last outputs: otherwise nothing is
    /// integrated.
    pub(crate) followed: bool,
    pub(crate) dt_s: f64,
}

/// The share of the acceleration that counts as gained airspeed: the rest is for a wind
/// that changes and the error of the angle of attack.
const GAINED_SHARE: f64 = 0.8;

/// Flies the aircraft out of an upset.
#[derive(Clone, Debug)]
pub(crate) struct Recovery {
    upset: UpsetDetector,
    /// The trims of undisturbed flight.
    trims: Surfaces,
    /// The schedule at which they were found.
    trimmed_at: f64,
    load: LoadLoop,
    throttle: RateLimit,
    /// The side of the roll, 1 right and -1 left, while it is kept.
    side: f64,
    spinning_s: f64,
    found_stall_mps: f64,
    /// The airspeed since the upset by what accelerates the aircraft, m/s.
    gained_mps: f64,
}

impl Recovery {
    pub(crate) const fn new() -> Self {
        Self {
            upset: UpsetDetector::new(),
            trims: Surfaces {
                throttle: 0.0,
                elevator: 0.0,
                aileron: 0.0,
                rudder: 0.0,
                ..Surfaces::IDLE
            },
            trimmed_at: 1.0,
            load: LoadLoop::new(),
            throttle: RateLimit::new(THROTTLE_RATE_PER_S),
            side: 0.0,
            spinning_s: 0.0,
            found_stall_mps: 0.0,
            gained_mps: 0.0,
        }
    }

    /// Begins with trims found at a schedule.
    pub(crate) const fn trimmed(trims: &Surfaces, schedule: Schedule) -> Self {
        Self {
            trims: *trims,
            trimmed_at: schedule.moment,
            ..Self::new()
        }
    }

    /// Whether the aircraft is being recovered.
    pub(crate) const fn is_active(&self) -> bool {
        self.upset.is_upset()
    }

    /// The airspeed at which the wing has stalled without load, m/s: above the
    /// configured one if it is iced, too heavy, or the airspeed is wrong; 0 if an
    /// elevator that was fully up has always had an effect.
    pub(crate) const fn found_stall_mps(&self) -> f64 {
        self.found_stall_mps
    }

    /// The estimate with an airspeed that is at least what the acceleration along the
    /// path has made of it since the upset began: one that reads too little, and ever
    /// less in a dive, would unload the wing until the ground.
    pub(crate) fn with_gained_airspeed(&mut self, estimate: &Estimate, dt_s: f64) -> Estimate {
        if !self.upset.is_upset() || self.upset.is_spinning() {
            self.gained_mps = estimate.airspeed_mps;
            return *estimate;
        }
        let gains = estimate.acceleration_mps2;
        self.gained_mps += if gains > 0.0 { GAINED_SHARE } else { 1.0 } * gains * dt_s;
        if self.gained_mps <= estimate.airspeed_mps {
            return *estimate;
        }
        let true_per_shown = estimate.true_airspeed_mps / estimate.airspeed_mps.max(1.0);
        Estimate {
            airspeed_mps: self.gained_mps,
            true_airspeed_mps: self.gained_mps * limit(true_per_shown, 1.0, 1.5),
            ..*estimate
        }
    }

    /// Ends a recovery that cannot go on.
    pub(crate) const fn end(&mut self) {
        self.upset = UpsetDetector::new();
    }

    /// Detects an upset, and its end. In undisturbed flight follows the `trims`
    /// that the loops have found.
    pub(crate) fn observe(
        &mut self,
        last: &Surfaces,
        trims: &Surfaces,
        estimate: &Estimate,
        inputs: &RecoveryInputs<'_>,
    ) -> Change {
        let (was, was_unanswered) = (self.upset.is_upset(), self.upset.is_unanswered());
        let elevator = if inputs.followed { last.elevator } else { 0.0 };
        let motion = Motion::of(estimate);
        let is = self
            .upset
            .step(estimate, &motion, elevator, inputs.envelope, inputs.dt_s);
        if !was_unanswered && self.upset.is_unanswered() {
            let load = estimate.load_factor.max(LEAST_LOAD);
            let stall_mps = estimate.airspeed_mps / (STALLED_RATIO * sqrt(load));
            let known_mps = inputs.envelope.stall_airspeed_mps.max(self.found_stall_mps);
            self.found_stall_mps = stall_mps.max(STALLED_RATIO * known_mps);
        }
        match (was, is) {
            (false, true) => {
                self.load.begin(estimate);
                self.throttle.reset(last.throttle);
                (self.side, self.spinning_s) = (0.0, 0.0);
                Change::Begins
            }
            (true, false) => Change::Ends,
            (true, true) => Change::None,
            (false, false) => {
                if inputs.followed
                    && motion.bank_rad.abs() < LEVEL_RAD
                    && estimate.body_rates.roll_radps.abs() < ROLLS_RADPS
                {
                    self.follow_trims(trims, inputs);
                }
                Change::None
            }
        }
    }

    fn follow_trims(&mut self, trims: &Surfaces, inputs: &RecoveryInputs<'_>) {
        let share = (inputs.dt_s / TRIM_TAU_S).min(1.0);
        let follow = |kept: &mut f64, found: f64| *kept += share * (found - *kept);
        follow(&mut self.trims.elevator, trims.elevator);
        follow(&mut self.trims.aileron, trims.aileron);
        follow(&mut self.trims.rudder, trims.rudder);
        follow(&mut self.trimmed_at, inputs.schedule.moment);
    }

    /// One step of the recovery.
    pub(crate) fn step(&mut self, estimate: &Estimate, inputs: &RecoveryInputs<'_>) -> Surfaces {
        let motion = Motion::of(estimate);
        if self.upset.is_spinning() {
            return self.stop_the_spin(estimate, inputs.dt_s);
        }
        self.spinning_s = 0.0;
        let roll_rate = self.roll_rate(&motion, estimate, inputs);
        let lateral = inputs.heading.surfaces_for(
            roll_rate,
            self.trims.aileron,
            self.trims.rudder,
            estimate,
            inputs.schedule,
        );
        let aileron = if self.upset.is_stalled() {
            limit_abs(lateral.aileron, STALLED_AILERON)
        } else {
            lateral.aileron
        };
        let rolls =
            motion.bank_rad.abs() > LEVEL_RAD || estimate.body_rates.roll_radps.abs() > ROLLS_RADPS;
        let trim = [self.trims.elevator, self.trimmed_at];
        Surfaces {
            throttle: self.throttle(&motion, estimate, inputs),
            elevator: self.load.step(&motion, estimate, inputs, trim, rolls),
            aileron,
            rudder: lateral.rudder,
            ..Surfaces::IDLE
        }
    }

    /// Power idle, ailerons neutral, rudder against the rotation, then elevator
    /// forward.
    fn stop_the_spin(&mut self, estimate: &Estimate, dt_s: f64) -> Surfaces {
        self.spinning_s += dt_s;
        self.load.begin(estimate);
        let elevator = if self.spinning_s < RUDDER_FIRST_S {
            0.0
        } else {
            let loaded = limit((estimate.load_factor - SPIN_UNLOADED) / 0.7, 0.0, 1.0);
            let drops = 1.0 + estimate.body_rates.pitch_radps / SPIN_NOSE_DROPS_RADPS;
            SPIN_ELEVATOR * loaded.min(limit(drops, 0.0, 1.0))
        };
        Surfaces {
            throttle: self.throttle.step(0.0, dt_s),
            elevator,
            aileron: self.trims.aileron,
            rudder: -estimate.body_rates.yaw_radps.signum(),
            ..Surfaces::IDLE
        }
    }

    /// The roll rate the shorter way to wings level, rad/s: slower with the nose
    /// near the vertical, where there is no bank.
    fn roll_rate(
        &mut self,
        motion: &Motion,
        estimate: &Estimate,
        inputs: &RecoveryInputs<'_>,
    ) -> f64 {
        let bank = motion.bank_rad;
        if bank.abs() < KEEPS_SIDE_RAD {
            self.side = 0.0;
        } else if self.side == 0.0 {
            let ahead = bank + ROLL_STOPS_S * estimate.body_rates.roll_radps;
            let passes = ahead.abs() > core::f64::consts::PI;
            self.side = if passes {
                bank.signum()
            } else {
                -bank.signum()
            };
        }
        let error = if self.side == 0.0 {
            -bank
        } else {
            self.side * bank.abs()
        };
        let [forward, ..] = motion.down;
        let level = limit((1.0 - forward * forward) / 0.25, 0.0, 1.0);
        // Full aileron only up to the highest airspeed of the outer loops, a
        // third of it 40 % above (14 CFR 23.349(a), before 2017).
        let over = estimate.airspeed_mps / inputs.envelope.max_airspeed_mps.max(1.0) - 1.0;
        let most = MAX_ROLL_RATE_RADPS * limit(1.0 - over / 0.6, 0.33, 1.0);
        level * limit_abs(ROLL_GAIN_PER_S * error, most)
    }

    /// The throttle by the airspeed to which the path leads: full a margin above
    /// the lowest, idle in the upper half.
    fn throttle(
        &mut self,
        motion: &Motion,
        estimate: &Estimate,
        inputs: &RecoveryInputs<'_>,
    ) -> f64 {
        let envelope = inputs.envelope;
        let ahead = estimate.airspeed_mps - SPEED_AHEAD_S * GRAVITY_MPS2 * sin(motion.path_rad);
        let slow = envelope.min_airspeed_mps + envelope.airspeed_margin_mps;
        let fast = 0.35 * envelope.min_airspeed_mps + 0.65 * envelope.max_airspeed_mps;
        let wanted = limit((fast - ahead) / (fast - slow).max(1.0), 0.0, 1.0);
        self.throttle.step(wanted, inputs.dt_s)
    }
}

/// What changed in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Change {
    None,
    Begins,
    Ends,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{AltitudeConfig, HeadingConfig};
    use fcc_core::flight::BodyRates;

    const DT_S: f64 = 0.025;

    /// A spin to the right: a turn in 3 s and 45 m/s of sink (FAA-H-8083-3C,
    /// chapter 5: 500 ft in a turn of 3 s), 45° nose down, 50 kt indicated.
    fn spinning() -> Estimate {
        Estimate {
            pitch_rad: -45.0_f64.to_radians(),
            airspeed_mps: 25.7,
            true_airspeed_mps: 46.0,
            climb_rate_mps: -45.0,
            load_factor: 1.2,
            body_rates: BodyRates {
                roll_radps: 85.0_f64.to_radians(),
                pitch_radps: 0.0,
                yaw_radps: 85.0_f64.to_radians(),
            },
            ..Estimate::default()
        }
    }

    /// FAA-H-8083-3C, spin recovery: power idle, ailerons neutral, rudder full
    /// opposite, elevator forward after it; rudder neutral when the rotation
    /// stops, then the pull out of the dive.
    #[test]
    fn a_spin_gets_the_handbooks_recovery() {
        let envelope = Envelope::default();
        let heading = HeadingLoop::new(HeadingConfig::default());
        let altitude = AltitudeLoop::new(AltitudeConfig::default(), &envelope);
        let inputs = RecoveryInputs {
            envelope: &envelope,
            schedule: Schedule::at(25.7, 51.4),
            heading: &heading,
            altitude: &altitude,
            followed: true,
            dt_s: DT_S,
        };
        let mut recovery = Recovery::new();
        let mut outputs = Surfaces {
            throttle: 0.6,
            ..Surfaces::default()
        };
        let mut fly = |estimate: &Estimate, ticks: u32| {
            for _ in 0..ticks {
                recovery.observe(&outputs, &Surfaces::default(), estimate, &inputs);
                outputs = recovery.step(estimate, &inputs);
            }
            outputs
        };
        let first = fly(&spinning(), 12);
        assert_eq!((first.rudder, first.elevator), (-1.0, 0.0));
        let later = fly(&spinning(), 80);
        assert_eq!((later.rudder, later.aileron), (-1.0, 0.0));
        assert_eq!(later.throttle, 0.0);
        assert!(later.elevator < -0.5);
        let stopped = Estimate {
            body_rates: BodyRates::default(),
            airspeed_mps: 45.0,
            ..spinning()
        };
        let pulls = fly(&stopped, 20);
        assert!(pulls.rudder.abs() < 0.3 && pulls.elevator > 0.0);
    }
}
