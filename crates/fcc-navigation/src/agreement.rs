//! Whether the inertial sensors agree with each other, before engaging.
//!
//! A wrong sign, unit, axis or offset contradicts an identity of motion (Stevens,
//! Lewis and Johnson 2016, sections 1.3 to 1.5, over a flat earth).

use libm::{cos, fabs, hypot, sin, sqrt, tan};

use super::force_sample::LEAST_AIRSPEED_MPS;
use super::sample_tracker::is_current;
use fcc_core::blocks::wrap_pi;
use fcc_core::flight::Measurements;
use fcc_core::framework::{ROUNDING_S, Time};
use fcc_core::units::GRAVITY_MPS2;

/// Readings are averaged over blocks of this length, s: angles, forces.
const ANGLE_BLOCK_S: f64 = 0.5;
const FORCE_BLOCK_S: f64 = 0.25;
/// The share of what was known that is left after a block: 1/e in 3 s, 6 s.
const ANGLES_KEPT: f64 = 0.85;
const FORCES_KEPT: f64 = 0.96;
/// The sums of the weights of four changes from block to block, known after 2.5 s,
/// of four blocks, 1 s, and of six, 1.5 s.
const FOUR_CHANGES: f64 = 3.1;
const FOUR_FORCES: f64 = 3.7;
const SIX_FORCES: f64 = 5.3;

/// Beyond these nothing is compared: bank and pitch, rad (60°).
const STEEP_RAD: f64 = 1.05;
/// Beyond this turn about the y and z axes no forces are compared: a spin, rad/s
/// (40 °/s).
const SPIN_RADPS: f64 = 0.7;

/// The squares of the least changes of an angle in a block, RMS, rad²: of both to
/// tell a sign (0.35°), of the larger to tell a unit or an offset (1°).
const LEAST_TO_TELL_A_SIGN: f64 = 0.006_109 * 0.006_109;
const LEAST_TO_TELL_A_UNIT: f64 = 0.017_453 * 0.017_453;
/// What counts at most of a block: a single jump of the attitude says nothing.
const MOST_OF_A_BLOCK: f64 = 1.5 * LEAST_TO_TELL_A_UNIT;
/// The correlation is -1 for a wrong sign; 0.5 for a delay of 0.25 s at 4 rad/s.
const OPPOSITE: f64 = -0.5;
/// The ratio of the squares: 3,300 for degrees taken for radians.
const OTHER_UNIT: f64 = 16.0;

/// The load over that of unaccelerated flight with this pitch and bank: m/s² taken
/// for g are 0.1, ft/s² taken for m/s² 3.3.
const LOADS: core::ops::RangeInclusive<f64> = 0.5..=2.0;
/// The vertical force that the path's curvature must not explain, m/s²; over 1.5 s
/// the angle of attack changes it by 6 m/s² at 50 m/s in a pull-up of 10°.
const LARGEST_UNEXPLAINED_MPS2: f64 = 6.0;
/// 2.9° of pitch, m/s².
const LARGEST_FORCE_MPS2: f64 = 0.5;
/// The slope of a random walk, as gusts are over seconds, has a standard deviation
/// of 1.2 times the residual over the spread of time: 3.7 of them.
const SLOPE_ERRORS: f64 = 4.5;
/// With a larger error of the slope, m/s², the airspeed shows gusts.
const LARGEST_ERROR_MPS2: f64 = 0.2;
/// A residual of few degrees of freedom is uncertain itself (Student's t at 0.1 %:
/// 8.6 of 4, 4.6 of 10): this over their square is added.
const FEW_DEGREES: f64 = 20.0;
/// The unknown angle of attack and sideslip, rad: with a turn about the y and the
/// z axis they are a force along the x axis, q w - r v.
const ANGLE_OF_ATTACK_RAD: f64 = 0.2;
const SIDESLIP_RAD: f64 = 0.15;

/// Which sensors contradict each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Contradictions {
    /// Pitch, roll and heading, and the body rates.
    pub attitude_and_rates: bool,
    /// The acceleration along the vertical axis, and gravity.
    pub load: bool,
    /// The acceleration along the forward axis, pitch and airspeed.
    pub pitch_and_force: bool,
}

/// Compares sensors with each other over some seconds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Agreement {
    roll: Derivative,
    pitch: Derivative,
    heading: Derivative,
    forces: Forces,
}

impl Agreement {
    pub(super) const fn new() -> Self {
        Self {
            roll: Derivative::NEW,
            pitch: Derivative::NEW,
            heading: Derivative::NEW,
            forces: Forces::NEW,
        }
    }

    /// One tick of `dt_s`; the airspeed is the sensor's, true.
    pub(super) fn step(&mut self, now: Time, sensed: &Measurements, airspeed_mps: f64, dt_s: f64) {
        if dt_s <= 0.0 {
            return;
        }
        let attitude = sensed.attitude.value;
        let (roll, pitch) = (attitude.roll_rad, attitude.pitch_rad);
        let is_steep = fabs(roll) > STEEP_RAD || fabs(pitch) > STEEP_RAD;
        if is_steep || !is_current(&sensed.attitude, now) || !is_current(&sensed.body_rates, now) {
            self.roll.interrupt();
            self.pitch.interrupt();
            self.heading.interrupt();
            self.forces = Forces::NEW;
            return;
        }
        let rates = sensed.body_rates.value;
        let (p, q, r) = (rates.roll_radps, rates.pitch_radps, rates.yaw_radps);
        let turn = q * sin(roll) + r * cos(roll);
        self.roll.step(roll, p + tan(pitch) * turn, dt_s);
        self.pitch.step(pitch, q * cos(roll) - r * sin(roll), dt_s);
        if is_current(&sensed.heading_rad, now) {
            self.heading
                .step(sensed.heading_rad.value, turn / cos(pitch), dt_s);
        } else {
            self.heading.interrupt();
        }
        let has_forces =
            is_current(&sensed.specific_force, now) && is_current(&sensed.airspeed_mps, now);
        if has_forces && hypot(q, r) < SPIN_RADPS {
            let force = sensed.specific_force.value;
            let down = GRAVITY_MPS2 * cos(pitch) * cos(roll);
            let means = [
                -force.z_mps2 / down,
                force.z_mps2 + down + q * airspeed_mps,
                q * airspeed_mps,
                r * airspeed_mps,
            ];
            let forward_mps2 = force.x_mps2 - GRAVITY_MPS2 * sin(pitch);
            self.forces.step(means, forward_mps2, airspeed_mps, dt_s);
        } else {
            self.forces = Forces::NEW;
        }
    }

    /// What contradicts.
    pub(super) fn contradictions(&self) -> Contradictions {
        let attitude_and_rates = [&self.roll, &self.pitch, &self.heading]
            .into_iter()
            .any(Derivative::is_contradicted);
        Contradictions {
            attitude_and_rates,
            // A wrong pitch rate is a wrong curvature of the path.
            load: self.forces.contradict_gravity() && !attitude_and_rates,
            pitch_and_force: self.forces.contradict_pitch(),
        }
    }
}

/// Means over a block.
#[derive(Clone, Copy, Debug)]
struct Block<const N: usize> {
    length_s: f64,
    sums: [f64; N],
}

impl<const N: usize> Block<N> {
    const NEW: Self = Self {
        length_s: 0.0,
        sums: [0.0; N],
    };

    /// Adds values; the means of a block that is complete.
    fn step(&mut self, values: [f64; N], dt_s: f64, length_s: f64) -> Option<[f64; N]> {
        self.length_s += dt_s;
        for (sum, value) in self.sums.iter_mut().zip(values) {
            *sum += value * dt_s;
        }
        (self.length_s + ROUNDING_S >= length_s).then(|| {
            let block = core::mem::replace(self, Self::NEW);
            block.sums.map(|sum| sum / block.length_s)
        })
    }
}

/// An angle, and a rate that should be its derivative: both as changes of their
/// means from block to block.
#[derive(Clone, Copy, Debug)]
struct Derivative {
    block: Block<2>,
    /// The last angle, rad.
    before_rad: Option<f64>,
    /// The change of the angle since the middle of the last block, and the
    /// integral of the rate, rad.
    changes_rad: [f64; 2],
    follows_a_block: bool,
    blocks: f64,
    /// The sums of the squares of both, and of their product, rad².
    measured: f64,
    integrated: f64,
    product: f64,
}

impl Derivative {
    const NEW: Self = Self {
        block: Block::NEW,
        before_rad: None,
        changes_rad: [0.0; 2],
        follows_a_block: false,
        blocks: 0.0,
        measured: 0.0,
        integrated: 0.0,
        product: 0.0,
    };

    /// What follows does not continue what was.
    const fn interrupt(&mut self) {
        self.block = Block::NEW;
        self.before_rad = None;
        self.changes_rad = [0.0; 2];
        self.follows_a_block = false;
    }

    fn step(&mut self, angle_rad: f64, rate_radps: f64, dt_s: f64) {
        let before_rad = self.before_rad.replace(angle_rad).unwrap_or(angle_rad);
        let [angle, turned] = self.changes_rad;
        self.changes_rad = [
            angle + wrap_pi(angle_rad - before_rad),
            turned + rate_radps * dt_s,
        ];
        let Some([angle, turned]) = self.block.step(self.changes_rad, dt_s, ANGLE_BLOCK_S) else {
            return;
        };
        if core::mem::replace(&mut self.follows_a_block, true) {
            let motion = angle * angle + turned * turned;
            let share = MOST_OF_A_BLOCK / motion.max(MOST_OF_A_BLOCK);
            self.blocks = ANGLES_KEPT * self.blocks + 1.0;
            self.measured = ANGLES_KEPT * self.measured + share * angle * angle;
            self.integrated = ANGLES_KEPT * self.integrated + share * turned * turned;
            self.product = ANGLES_KEPT * self.product + share * angle * turned;
        }
        let [last_angle, last_turned] = self.changes_rad;
        self.changes_rad = [last_angle - angle, last_turned - turned];
    }

    fn is_contradicted(&self) -> bool {
        let (less, more) = if self.measured < self.integrated {
            (self.measured, self.integrated)
        } else {
            (self.integrated, self.measured)
        };
        let is_opposite = less > LEAST_TO_TELL_A_SIGN * self.blocks
            && self.product < OPPOSITE * sqrt(less * more);
        let has_other_unit = more > LEAST_TO_TELL_A_UNIT * self.blocks && more > OTHER_UNIT * less;
        self.blocks > FOUR_CHANGES && (is_opposite || has_other_unit)
    }
}

/// The specific force against gravity, the path's curvature and the change of the
/// airspeed V: `f_z + g cos θ cos φ + q u - p v = w'`, `f_x - g sin θ - q w + r v = u'`
/// (Stevens, Lewis and Johnson 2016, section 2.5).
#[derive(Clone, Copy, Debug)]
struct Forces {
    block: Block<5>,
    /// The integral of `f_x - g sin θ`, m/s.
    gained_mps: f64,
    /// The line through the airspeed less that integral.
    line: Line,
    blocks: f64,
    /// The load; the vertical force that is not explained, q V and r V, m/s².
    means: [f64; 4],
}

impl Forces {
    const NEW: Self = Self {
        block: Block::NEW,
        gained_mps: 0.0,
        line: Line::NEW,
        blocks: 0.0,
        means: [0.0; 4],
    };

    fn step(&mut self, means: [f64; 4], forward_mps2: f64, airspeed_mps: f64, dt_s: f64) {
        self.gained_mps += forward_mps2 * dt_s;
        if airspeed_mps < LEAST_AIRSPEED_MPS {
            self.line = Line::NEW;
        }
        let [load, unexplained, pitching, yawing] = means;
        let not_gained = airspeed_mps - self.gained_mps;
        let values = [load, unexplained, pitching, yawing, not_gained];
        let Some([means @ .., not_gained]) = self.block.step(values, dt_s, FORCE_BLOCK_S) else {
            return;
        };
        self.blocks = FORCES_KEPT * self.blocks + 1.0;
        for (mean, value) in self.means.iter_mut().zip(means) {
            *mean += (value - *mean) / self.blocks;
        }
        if airspeed_mps >= LEAST_AIRSPEED_MPS {
            self.line.step(not_gained);
        }
    }

    fn contradict_gravity(&self) -> bool {
        let [load, unexplained, ..] = self.means;
        self.blocks > SIX_FORCES
            && !LOADS.contains(&load)
            && fabs(unexplained) > LARGEST_UNEXPLAINED_MPS2
    }

    fn contradict_pitch(&self) -> bool {
        let [.., pitching, yawing] = self.means;
        self.line.weight > FOUR_FORCES && {
            let (slope, error) = self.line.slope();
            let turning = ANGLE_OF_ATTACK_RAD * fabs(pitching) + SIDESLIP_RAD * fabs(yawing);
            error < LARGEST_ERROR_MPS2
                && fabs(slope) > hypot(LARGEST_FORCE_MPS2, SLOPE_ERRORS * error) + turning
        }
    }
}

/// A line through the values of blocks, older ones with less weight.
#[derive(Clone, Copy, Debug)]
struct Line {
    weight: f64,
    time_s: f64,
    value: f64,
    /// Weighted sums of squares and products about the means.
    time_squares: f64,
    products: f64,
    value_squares: f64,
}

impl Line {
    const NEW: Self = Self {
        weight: 0.0,
        time_s: 0.0,
        value: 0.0,
        time_squares: 0.0,
        products: 0.0,
        value_squares: 0.0,
    };

    fn step(&mut self, value: f64) {
        // The time of the newest block is 0.
        self.time_s -= FORCE_BLOCK_S;
        self.weight = FORCES_KEPT * self.weight + 1.0;
        let (time, from_mean) = (-self.time_s, value - self.value);
        let share = 1.0 - 1.0 / self.weight;
        self.time_squares = FORCES_KEPT * self.time_squares + share * time * time;
        self.products = FORCES_KEPT * self.products + share * time * from_mean;
        self.value_squares = FORCES_KEPT * self.value_squares + share * from_mean * from_mean;
        self.time_s += time / self.weight;
        self.value += from_mean / self.weight;
    }

    /// Its slope per second, and the residual over the spread of time, for few
    /// blocks more.
    fn slope(&self) -> (f64, f64) {
        let slope = self.products / self.time_squares;
        let residual = (self.value_squares - slope * self.products).max(0.0);
        let degrees = self.weight - 2.0;
        let variance = residual / self.time_squares * self.weight / degrees;
        (
            slope,
            (1.0 + FEW_DEGREES / (degrees * degrees)) * sqrt(variance),
        )
    }
}

#[cfg(test)]
mod tests;
