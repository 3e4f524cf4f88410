//! Load → pitch rate → elevator, while the aircraft is recovered.

use libm::{cos, sqrt};

use super::upset::Motion;
use super::{Envelope, RecoveryInputs};
use fcc_core::blocks::{LowPass, limit, limit_abs};
use fcc_core::units::GRAVITY_MPS2;
use fcc_navigation::Estimate;

/// The load while the lift would not raise the path, g: between the 0 and 0.5
/// at which a light aircraft's engine runs and its wing does not stall.
const UNLOADED: f64 = 0.3;
/// How much of the load at which the wing stalls is used: (V/Vs)² times this.
const OF_STALL_LOAD: f64 = 0.75;
/// How much of the load is used while rolling: two thirds (14 CFR 23.349, in its
/// form before 2017).
const ROLLING: f64 = 2.0 / 3.0;
/// How much of the limit load is commanded: the rest is for overshoot and gusts.
const OF_LIMIT_LOAD: f64 = 0.8;
/// Below this bank the lift is used in full, and beyond 90° not at all: cos 50°.
const FULL_LIFT: f64 = 0.643;
/// With the nose this far down any pull raises it, whatever the bank: sin 65°.
const STEEP: f64 = 0.906;
/// How fast the commanded load grows at most, g/s, and the time constant with which
/// it reaches what is wanted, s: an aircraft whose elevator gives more load than
/// was configured would overshoot the end of a ramp.
const LOAD_RATE_PER_S: f64 = 4.0;
const LOAD_TAU_S: f64 = 0.3;
/// The lag of the load behind the elevator, with that of servos and sensors, s.
const LOAD_LAG_S: f64 = 0.25;
/// Path rate per path error, 1/s.
const PATH_GAIN_PER_S: f64 = 1.2;
/// Pitch rate per load error, rad/s per g.
const LOAD_GAIN_RADPS: f64 = 0.25;
/// The largest commanded pitch rate, rad/s.
const MAX_PITCH_RATE_RADPS: f64 = 0.9;
/// The angle of attack that is not exceeded while slow, rad (11°), the gain to it,
/// 1/s, and the multiple of the stalling airspeed up to which it is looked at:
/// above, load bounds it.
const MAX_ALPHA_RAD: f64 = 0.192;
const ALPHA_GAIN_PER_S: f64 = 2.0;
const ALPHA_BELOW: f64 = 1.6;
/// Below this multiple of the stalling airspeed the path is not computed from
/// pitch rates: they would become infinite.
const LEAST_SPEED: f64 = 0.6;
/// The largest correction of the elevator by integration.
const MAX_CORRECTION: f64 = 0.5;
/// How far ahead the load's error is extrapolated, s, and the time constant of the
/// filter that differentiates the load, s.
const LOAD_AHEAD_S: f64 = 0.2;
const LOAD_RATE_TAU_S: f64 = 0.1;

/// Turns the path to the horizon, as far as lift can: load → pitch rate →
/// elevator.
#[derive(Clone, Debug)]
pub(super) struct LoadLoop {
    /// The commanded load, g.
    load: f64,
    /// The load expected now from the past commands, g.
    expected: LowPass,
    /// The load a little earlier, g.
    slower: LowPass,
    /// The elevator's correction by integration.
    correction: f64,
}

impl LoadLoop {
    pub(super) const fn new() -> Self {
        Self {
            load: 1.0,
            expected: LowPass::new(LOAD_LAG_S),
            slower: LowPass::new(LOAD_RATE_TAU_S),
            correction: 0.0,
        }
    }

    /// Begins anew.
    pub(super) fn begin(&mut self, estimate: &Estimate) {
        self.correction = 0.0;
        self.begin_load(estimate);
    }

    /// Commands the present load, but none that is less than that of unloading.
    fn begin_load(&mut self, estimate: &Estimate) {
        let load = estimate.load_factor.max(UNLOADED);
        self.load = load;
        self.expected.reset(load);
        self.slower.reset(estimate.load_factor);
    }

    /// One step; returns the elevator. `trim` is that of undisturbed flight,
    /// `trimmed_at` the schedule at which it was found, and `rolls` says that the
    /// aircraft is not level.
    pub(super) fn step(
        &mut self,
        motion: &Motion,
        estimate: &Estimate,
        inputs: &RecoveryInputs<'_>,
        [trim, trimmed_at]: [f64; 2],
        rolls: bool,
    ) -> f64 {
        if !inputs.followed {
            self.begin_load(estimate);
        }
        let wanted = wanted_load(motion, estimate, inputs.envelope, rolls);
        let rate_per_s = limit_abs((wanted - self.load) / LOAD_TAU_S, LOAD_RATE_PER_S);
        self.load += inputs.dt_s * rate_per_s;
        let load = self.load;
        let expected = self.expected.step(load, inputs.dt_s);
        let slower = self.slower.step(estimate.load_factor, inputs.dt_s);
        let gained =
            (estimate.load_factor - slower) / LOAD_RATE_TAU_S - (load - expected) / LOAD_LAG_S;
        let stall_mps = inputs.envelope.stall_airspeed_mps;
        let speed = estimate.true_airspeed_mps.max(LEAST_SPEED * stall_mps);
        let [_, _, down] = motion.down;
        // The pitch rate of a path that is curved by a load n: g/V (n - cos θ cos
        // φ).
        let turning = |n: f64| GRAVITY_MPS2 / speed * (n - down);
        let by_load = LOAD_GAIN_RADPS * (expected - estimate.load_factor - LOAD_AHEAD_S * gained);
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
        let error = pitch_rate - estimate.body_rates.pitch_radps;
        let elevator = inputs.altitude.elevator_for(
            error,
            load * inputs.schedule.moment - trimmed_at,
            trim + self.correction,
            inputs.schedule,
        );
        // While the aircraft rolls, its path turns by sideslip, too: so what is
        // integrated is the load.
        let drift = if at_limit { error } else { by_load };
        if inputs.followed && (elevator.abs() < 1.0 || elevator * drift < 0.0) {
            let increment = inputs
                .altitude
                .elevator_increment(drift, inputs.schedule, inputs.dt_s);
            self.correction = limit_abs(self.correction + increment, MAX_CORRECTION);
        }
        limit_abs(elevator, 1.0)
    }
}

/// The load that turns the path to the horizon, as far as the lift raises it, g.
fn wanted_load(motion: &Motion, estimate: &Estimate, envelope: &Envelope, rolls: bool) -> f64 {
    let [forward, right, down] = motion.down;
    let upright = down / sqrt(right * right + down * down).max(1e-6);
    let speed = estimate.true_airspeed_mps.max(1.0);
    let path_rate = -PATH_GAIN_PER_S * motion.path_rad;
    let wanted =
        (cos(motion.path_rad) + speed / GRAVITY_MPS2 * path_rate) / limit(upright, FULL_LIFT, 1.0);
    let ratio = estimate.airspeed_mps / envelope.stall_airspeed_mps;
    let strength = OF_LIMIT_LOAD * envelope.limit_load_factor;
    let most = if rolls { ROLLING * strength } else { strength };
    let most = most.min(OF_STALL_LOAD * ratio * ratio).max(UNLOADED);
    let pull = limit(wanted, UNLOADED, most);
    let share = limit(upright / FULL_LIFT, 0.0, 1.0).max(limit(
        (forward - STEEP) / (1.0 - STEEP),
        0.0,
        1.0,
    ));
    UNLOADED + share * (pull - UNLOADED)
}
