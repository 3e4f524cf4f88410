//! Whether the rudder turns the aircraft the other way than it should.

use super::SurfaceEffect;
use crate::blocks::LowPass;

/// Tells a reversed rudder by the yaw.
///
/// Of a rudder for which the linkage or the servo is reversed the side force grows with what is
/// commanded against it, so that the rudder goes to its stop. What else yaws is a sideslip, which
/// the side force measures, and the ailerons.
#[derive(Clone, Debug)]
pub(crate) struct ReversedRudder {
    effect: SurfaceEffect,
    side_force: LowPass,
    is_s: f64,
    slips_s: f64,
}

impl ReversedRudder {
    /// A full rudder yaws light aircraft at cruise by 1 rad/s² (JSBSim's c172p and c182 0.7 to
    /// 2, in turbulence down to -0.05): beyond this, rad/s², and for this time, s, it is reversed.
    const REVERSED: f64 = -0.35;
    const AFTER_S: f64 = 1.0;
    /// The mean square of rudders below which nothing is said: 0.015 of full deflection.
    const LEAST_SQUARE: f64 = 2.25e-4;
    /// The side force, m/s², that it makes, for the same time in all.
    const SIDE_FORCE_MPS2: f64 = 0.8;
    const SIDE_FORCE_LAG_S: f64 = 0.5;

    pub(crate) const fn new() -> Self {
        Self {
            effect: SurfaceEffect::new(),
            side_force: LowPass::new(Self::SIDE_FORCE_LAG_S),
            is_s: 0.0,
            slips_s: 0.0,
        }
    }

    /// Whether it seems so: then what else does not answer may be its doing.
    pub(crate) const fn seems(&self) -> bool {
        self.is_s > 0.0 && self.slips_s > 0.0
    }

    /// Takes the rudder, the yaw rate in excess of the turn's, and the side force and the
    /// ailerons.
    pub(crate) fn step(
        &mut self,
        rudder: f64,
        yaw_radps: f64,
        causes: [f64; 2],
        dt_s: f64,
    ) -> bool {
        let [side_mps2, _] = causes;
        let slips = self.side_force.step(side_mps2, dt_s).abs() > Self::SIDE_FORCE_MPS2;
        let passed_s = if slips { dt_s } else { -0.5 * dt_s };
        self.slips_s = (self.slips_s + passed_s).clamp(0.0, 2.0 * Self::AFTER_S);
        let effect = self.effect.step(rudder, yaw_radps, causes, dt_s);
        let is_reversed = effect < Self::REVERSED && self.effect.mean_square() > Self::LEAST_SQUARE;
        self.is_s = if is_reversed { self.is_s + dt_s } else { 0.0 };
        self.is_s.min(self.slips_s) > Self::AFTER_S
    }
}
