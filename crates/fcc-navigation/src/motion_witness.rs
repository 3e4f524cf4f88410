//! Roll and pitch by what comes from neither attitude nor gyroscopes: forces, path and heading.

use libm::{asin, atan2, cos};

use super::force_sample::LEAST_AIRSPEED_MPS;
use super::scalar_update::squared;
use fcc_core::blocks::{LowPass, limit_abs, wrap_pi};
use fcc_core::flight::Attitude;
use fcc_core::units::GRAVITY_MPS2;

/// The lag of what is compared, s: the change of airspeed and heading is that over it.
const LAG_S: f64 = 2.0;
/// The offsets to the attitude are learned in this time, s.
const LEARNED_S: f64 = 20.0;
/// Standard deviations in calm air, rad: of roll (5°: while a turn begins and ends, the error
/// lasts for seconds) and of pitch (2°).
const ROLL_SD_RAD: f64 = 0.087;
const PITCH_SD_RAD: f64 = 0.035;
/// Beyond these nothing is compared: bank and pitch, rad (50°, 40°).
const STEEP_BANK_RAD: f64 = 0.87;
const STEEP_PITCH_RAD: f64 = 0.7;

/// One tick's inputs; none is what is not measured.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct WitnessInput {
    /// Specific force along x, m/s².
    pub(super) forward_mps2: Option<f64>,
    pub(super) heading_rad: Option<f64>,
    /// True, by a sensor, m/s.
    pub(super) airspeed_mps: Option<f64>,
    pub(super) climb_rate_mps: Option<f64>,
    pub(super) angle_of_attack_rad: f64,
    /// Standard deviation of vertical gusts, m/s.
    pub(super) gusts_mps: f64,
}

/// Pitch from the force along x without the change of the airspeed, and from path and angle of
/// attack; roll from the turn that the heading shows, tan φ = V ψ' / g.
#[derive(Clone, Debug)]
pub(super) struct MotionWitness {
    roll: LowPass,
    pitch: LowPass,
    heading: LowPass,
    heading_rad: f64,
    airspeed: LowPass,
    forward: LowPass,
    by_path: LowPass,
    /// Attitude less that by the integrated rates.
    apart: [LowPass; 2],
    /// Without those of the attitude, as learned, rad.
    offsets: [LowPass; 2],
    /// Roll and pitch less those of the attitude and what was learned, rad.
    differ: [Option<f64>; 2],
}

impl MotionWitness {
    pub(super) const fn new() -> Self {
        const LAG: LowPass = LowPass::new(LAG_S);
        Self {
            roll: LAG,
            pitch: LAG,
            heading: LAG,
            heading_rad: 0.0,
            airspeed: LAG,
            forward: LAG,
            by_path: LAG,
            apart: [LAG; 2],
            offsets: [LowPass::new(LEARNED_S); 2],
            differ: [None; 2],
        }
    }

    /// Attitude and integrated rates agree from now on.
    pub(super) const fn agree(&mut self) {
        self.apart = [LowPass::new(LAG_S); 2];
    }

    /// One tick; `apart` is the attitude less that by the integrated rates.
    pub(super) fn step(
        &mut self,
        input: &WitnessInput,
        of: Attitude,
        apart: [f64; 2],
        learns: bool,
        dt_s: f64,
    ) {
        for (lag, apart) in self.apart.iter_mut().zip(apart) {
            lag.step(apart, dt_s);
        }
        let roll_rad = self.roll.step(of.roll_rad, dt_s);
        let pitch_rad = self.pitch.step(of.pitch_rad, dt_s);
        let Some(airspeed_mps) = input.airspeed_mps.filter(|mps| *mps > LEAST_AIRSPEED_MPS) else {
            *self = Self {
                offsets: self.offsets,
                ..Self::new()
            };
            return;
        };
        let accelerates = (airspeed_mps - self.airspeed.step(airspeed_mps, dt_s)) / LAG_S;
        let by_force = input.forward_mps2.map(|mps2| {
            let forward = self.forward.step(mps2, dt_s) - accelerates;
            asin(limit_abs(forward / GRAVITY_MPS2, 1.0))
        });
        let by_path = input.climb_rate_mps.map(|mps| {
            let path_rad = asin(limit_abs(mps / airspeed_mps, 1.0));
            let attack_rad = input.angle_of_attack_rad * cos(of.roll_rad);
            self.by_path.step(path_rad + attack_rad, dt_s)
        });
        let pitch = match (by_force, by_path) {
            (Some(force), Some(path)) => Some(0.5 * (force + path)),
            (force, path) => force.or(path),
        };
        let roll = input.heading_rad.map(|rad| {
            self.heading_rad += wrap_pi(rad - self.heading_rad);
            let turns = (self.heading_rad - self.heading.step(self.heading_rad, dt_s)) / LAG_S;
            atan2(airspeed_mps * turns, GRAVITY_MPS2)
        });
        let is_steep = of.roll_rad.abs() > STEEP_BANK_RAD || of.pitch_rad.abs() > STEEP_PITCH_RAD;
        let off = [
            roll.map(|rad| rad - roll_rad),
            pitch.map(|rad| rad - pitch_rad),
        ];
        for ((differ, offset), off) in self.differ.iter_mut().zip(&mut self.offsets).zip(off) {
            *differ = off.filter(|_| !is_steep).map(|off| {
                if learns {
                    offset.step(off, dt_s);
                }
                off - offset.output()
            });
        }
    }

    /// The change of the logarithm of the odds that the attitude is right and not what
    /// the integrated rates say: the ratio of two normal distributions, with one independent
    /// sample in each lag.
    pub(super) fn odds(&self, input: &WitnessInput, dt_s: f64) -> f64 {
        let airspeed_mps = input.airspeed_mps.unwrap_or(LEAST_AIRSPEED_MPS);
        let gusts = squared(input.gusts_mps / airspeed_mps.max(LEAST_AIRSPEED_MPS));
        let sds = [ROLL_SD_RAD, PITCH_SD_RAD];
        let each = self.differ.iter().zip(&self.apart).zip(sds);
        each.fold(0.0, |sum, ((differ, apart), sd)| {
            let apart = apart.output();
            let variance = squared(sd) + gusts;
            sum + differ.map_or(0.0, |differ| apart * (differ + 0.5 * apart) / variance)
        }) * dt_s
            / LAG_S
    }
}
