//! Recovery from an upset.
//!
//! In the order of FAA-H-8083-3C, chapter 5 (upset recovery): unload, roll the
//! shorter way to wings level, power by the speed, then pull to the horizon
//! within load, angle of attack and speed. A spin gets power idle, ailerons
//! neutral, full rudder against it, then elevator forward (the same handbook,
//! chapter 5, spin recovery; Bowman, NASA TP-2939, 1989). Neither heading nor
//! altitude is followed meanwhile.

use libm::{cos, sin, sqrt};

use super::upset::{Motion, UpsetDetector};
use super::{AltitudeLoop, Envelope, HeadingLoop, Schedule};
use crate::blocks::{RateLimit, limit, limit_abs};
use crate::flight::Surfaces;
use crate::flight::navigation::Estimate;
use crate::units::GRAVITY_MPS2;

/// The load while the lift would not raise the path, g: between the 0 and 0.5
/// in which light aircraft's engines run and the wing does not stall.
const UNLOADED: f64 = 0.3;
/// How much of the load at which the wing stalls is used: (V/Vs)² times this.
const OF_STALL_LOAD: f64 = 0.75;
/// How much of the load is used while rolling: two thirds (14 CFR 23.349(b), in
/// its form before 2017).
const ROLLING: f64 = 2.0 / 3.0;
/// The most load of the recovery over the outer loops' largest.
const OVER_OUTER_LOOPS: f64 = 1.5;
/// Below this bank the lift is used in full, and beyond 90° not at all: cos 50°.
const FULL_LIFT: f64 = 0.643;
/// Wings level enough for the full load: bank, rad (25°), and roll rate, rad/s
/// (30 °/s).
const LEVEL_RAD: f64 = 0.436;
const ROLLS_RADPS: f64 = 0.524;
/// With the nose this far down any pull raises it, whatever the bank: sin 65°.
const STEEP: f64 = 0.906;
/// How fast the commanded load grows, g/s.
const LOAD_RATE_PER_S: f64 = 4.0;
/// Path rate per path error, 1/s.
const PATH_GAIN_PER_S: f64 = 1.2;
/// Roll rate per bank, 1/s, and the largest, rad/s: beyond what ailerons of
/// light aircraft give, so that they are fully used.
const ROLL_GAIN_PER_S: f64 = 2.6;
const MAX_ROLL_RATE_RADPS: f64 = 2.6;
/// How far ahead the roll is extrapolated for the shorter way, s: the time in
/// which it is stopped.
const ROLL_STOPS_S: f64 = 0.2;
/// Beyond this bank the side once chosen is kept, rad (140°).
const KEEPS_SIDE_RAD: f64 = 2.44;
/// Pitch rate per load error, rad/s per g.
const LOAD_GAIN_RADPS: f64 = 0.25;
/// The largest commanded pitch rate, rad/s.
const MAX_PITCH_RATE_RADPS: f64 = 0.9;
/// The angle of attack that is not exceeded while slow, rad (11°), the gain to it
/// 1/s, and the multiple of the stalling airspeed up to which it is looked at:
/// above, load bounds it.
const MAX_ALPHA_RAD: f64 = 0.192;
const ALPHA_GAIN_PER_S: f64 = 2.0;
const ALPHA_BELOW: f64 = 1.6;
/// The largest correction of the elevator by integration.
const MAX_CORRECTION: f64 = 0.5;
/// The ailerons' share while the wing is stalled: they drop the wing they raise.
const STALLED_AILERON: f64 = 0.3;
/// How far ahead the airspeed is extrapolated for the throttle, s.
const SPEED_AHEAD_S: f64 = 2.0;
/// How long the rudder acts in a spin before the elevator, s.
const RUDDER_FIRST_S: f64 = 0.3;
/// The elevator in a spin, less than all of it: more load would turn negative.
const SPIN_ELEVATOR: f64 = -0.7;
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

/// Flies the aircraft out of an upset.
#[derive(Clone, Debug)]
pub(crate) struct Recovery {
    upset: UpsetDetector,
    /// The trims of undisturbed flight.
    trims: Surfaces,
    /// The schedule at which they were found.
    trimmed_at: f64,
    load: RateLimit,
    throttle: RateLimit,
    /// The elevator's correction by integration.
    correction: f64,
    /// The side of the roll, 1 right and -1 left, while it is kept.
    side: f64,
    spinning_s: f64,
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
            },
            trimmed_at: 1.0,
            load: RateLimit::new(LOAD_RATE_PER_S),
            throttle: RateLimit::new(1.0),
            correction: 0.0,
            side: 0.0,
            spinning_s: 0.0,
        }
    }

    /// Whether the aircraft is being recovered.
    pub(crate) const fn is_active(&self) -> bool {
        self.upset.is_upset()
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
        let was = self.upset.is_upset();
        let is = self.upset.step(estimate, inputs.envelope, inputs.dt_s);
        match (was, is) {
            (false, true) => {
                self.load.reset(estimate.load_factor);
                self.throttle.reset(last.throttle);
                (self.correction, self.side, self.spinning_s) = (0.0, 0.0, 0.0);
                Change::Begins
            }
            (true, false) => Change::Ends,
            (true, true) => Change::None,
            (false, false) => {
                let motion = Motion::of(estimate);
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
        Surfaces {
            throttle: self.throttle(&motion, estimate, inputs),
            elevator: self.elevator(&motion, estimate, inputs),
            aileron,
            rudder: lateral.rudder,
        }
    }

    /// Power idle, ailerons neutral, rudder against the rotation, then elevator
    /// forward.
    fn stop_the_spin(&mut self, estimate: &Estimate, dt_s: f64) -> Surfaces {
        self.spinning_s += dt_s;
        self.correction = 0.0;
        self.load.reset(UNLOADED);
        let elevator = if self.spinning_s < RUDDER_FIRST_S {
            0.0
        } else {
            SPIN_ELEVATOR
        };
        Surfaces {
            throttle: self.throttle.step(0.0, dt_s),
            elevator,
            aileron: self.trims.aileron,
            rudder: -estimate.body_rates.yaw_radps.signum(),
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

    /// The load that turns the path to the horizon, as far as the lift raises it,
    /// g.
    fn wanted_load(&self, motion: &Motion, estimate: &Estimate, envelope: &Envelope) -> f64 {
        let [forward, right, down] = motion.down;
        let upright = down / sqrt(right * right + down * down).max(1e-6);
        let speed = estimate.true_airspeed_mps.max(1.0);
        let path_rate = -PATH_GAIN_PER_S * motion.path_rad;
        let wanted = (cos(motion.path_rad) + speed / GRAVITY_MPS2 * path_rate)
            / limit(upright, FULL_LIFT, 1.0);
        let rolls =
            motion.bank_rad.abs() > LEVEL_RAD || estimate.body_rates.roll_radps.abs() > ROLLS_RADPS;
        let ratio = estimate.airspeed_mps / envelope.stall_airspeed_mps();
        let strength =
            OVER_OUTER_LOOPS * envelope.max_load_factor * if rolls { ROLLING } else { 1.0 };
        let most = strength.min(OF_STALL_LOAD * ratio * ratio).max(UNLOADED);
        let pull = limit(wanted, UNLOADED, most);
        let share = limit(upright / FULL_LIFT, 0.0, 1.0).max(limit(
            (forward - STEEP) / (1.0 - STEEP),
            0.0,
            1.0,
        ));
        UNLOADED + share * (pull - UNLOADED)
    }

    fn elevator(
        &mut self,
        motion: &Motion,
        estimate: &Estimate,
        inputs: &RecoveryInputs<'_>,
    ) -> f64 {
        let wanted = self.wanted_load(motion, estimate, inputs.envelope);
        let load = self.load.step(wanted, inputs.dt_s);
        let stall_mps = inputs.envelope.stall_airspeed_mps();
        let speed = estimate.true_airspeed_mps.max(0.6 * stall_mps);
        let [_, _, down] = motion.down;
        // The pitch rate of a path that is curved by a load n: g/V (n - cos θ cos
        // φ).
        let turning = |n: f64| GRAVITY_MPS2 / speed * (n - down);
        let by_load = LOAD_GAIN_RADPS * (load - estimate.load_factor);
        let mut pitch_rate = turning(load) + by_load;
        let mut at_limit = false;
        if estimate.airspeed_mps < ALPHA_BELOW * stall_mps {
            // The angle of attack changes by the pitch rate less that of the path.
            let most = turning(estimate.load_factor)
                + ALPHA_GAIN_PER_S * (MAX_ALPHA_RAD - motion.angle_of_attack_rad);
            at_limit = pitch_rate > most;
            pitch_rate = pitch_rate.min(most);
        }
        let pitch_rate = limit_abs(pitch_rate, MAX_PITCH_RATE_RADPS);
        let moment = inputs.schedule.moment;
        let error = pitch_rate - estimate.body_rates.pitch_radps;
        let surface = inputs.altitude.elevator_for(
            error,
            load * moment - self.trimmed_at,
            self.trims.elevator + self.correction,
            inputs.schedule,
        );
        // While the aircraft rolls, its path turns by sideslip, too: so what is
        // integrated is the load.
        let drift = if at_limit { error } else { by_load };
        if inputs.followed && (surface.abs() < 1.0 || surface * error < 0.0) {
            let increment = inputs
                .altitude
                .elevator_increment(drift, inputs.schedule, inputs.dt_s);
            self.correction = limit_abs(self.correction + increment, MAX_CORRECTION);
        }
        limit_abs(surface, 1.0)
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
