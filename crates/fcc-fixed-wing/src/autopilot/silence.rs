//! The controls that an aircraft is left with which is not heard: those of straight
//! and level flight. What the loops have found in a turn, or on the way into it, rolls
//! it on.

use super::Autopilot;
use fcc_core::blocks::LowPass;
use fcc_core::flight::Surfaces;
use fcc_navigation::Estimate;

/// They are learned with this time constant, s.
const LEARNED_S: f64 = 10.0;
/// While bank and commanded bank, rad, and climb rate, m/s, are within these, in the
/// mean of so long, s: shorter than a turn, longer than gusts and the passage through
/// wings level of a turn to the other side.
const STRAIGHT_RAD: f64 = 0.05;
const LEVEL_MPS: f64 = 1.0;
const MEAN_S: f64 = 2.0;
/// Elevator and throttle hold at about the airspeed of which they are, as a share of it,
/// and with about the same elevator trim.
const SAME_AIRSPEED: f64 = 0.1;
const SAME_TRIM: f64 = 0.02;

/// The controls of straight and level flight.
#[derive(Clone, Copy, Debug)]
pub(super) struct StraightTrims {
    aileron: LowPass,
    rudder: LowPass,
    elevator: LowPass,
    throttle: LowPass,
    elevator_trim: LowPass,
    airspeed_mps: LowPass,
    /// Of the last seconds.
    bank_rad: LowPass,
    commanded_rad: LowPass,
    climb_mps: LowPass,
}

impl Default for StraightTrims {
    fn default() -> Self {
        let (learned, mean) = (LowPass::new(LEARNED_S), LowPass::new(MEAN_S));
        Self {
            aileron: learned,
            rudder: learned,
            elevator: learned,
            throttle: learned,
            elevator_trim: learned,
            airspeed_mps: learned,
            bank_rad: mean,
            commanded_rad: mean,
            climb_mps: mean,
        }
    }
}

impl StraightTrims {
    /// Whether the last seconds were straight and level.
    fn is_level(&mut self, estimate: &Estimate, commanded_rad: f64, dt_s: f64) -> bool {
        let bank_rad = self.bank_rad.step(estimate.roll_rad, dt_s);
        let commanded_rad = self.commanded_rad.step(commanded_rad, dt_s);
        let climb_mps = self.climb_mps.step(estimate.climb_rate_mps, dt_s);
        bank_rad.abs() < STRAIGHT_RAD
            && commanded_rad.abs() < STRAIGHT_RAD
            && climb_mps.abs() < LEVEL_MPS
    }

    /// Takes a part of these trims of an airspeed, m/s.
    fn take(&mut self, trims: &Surfaces, airspeed_mps: f64, dt_s: f64) {
        self.aileron.step(trims.aileron, dt_s);
        self.rudder.step(trims.rudder, dt_s);
        self.elevator.step(trims.elevator, dt_s);
        self.throttle.step(trims.throttle, dt_s);
        self.elevator_trim
            .step(trims.elevator_trim.unwrap_or(0.0), dt_s);
        self.airspeed_mps.step(airspeed_mps, dt_s);
    }

    /// Whether elevator and throttle are those of this flight.
    fn fits(&self, airspeed_mps: f64, elevator_trim: Option<f64>) -> bool {
        let learned_mps = self.airspeed_mps.output();
        let trim_off = elevator_trim.unwrap_or(0.0) - self.elevator_trim.output();
        (airspeed_mps - learned_mps).abs() < SAME_AIRSPEED * learned_mps
            && trim_off.abs() < SAME_TRIM
    }
}

impl Autopilot {
    /// Begins with what was found at engaging.
    pub(super) fn begin_straight_trims(&mut self) {
        self.loops.straight = StraightTrims::default();
        self.take_straight_trims(0.0);
    }

    /// Learns in straight and level flight by the usual loops.
    pub(super) fn learn_straight_trims(&mut self, estimate: &Estimate, dt_s: f64) {
        let commanded_rad = self.guidance.setpoints.roll_rad;
        let is_level = self.loops.straight.is_level(estimate, commanded_rad, dt_s);
        let is_usual = self.guidance.runway().is_none()
            && !self.loops.glides
            && !self.loops.recovery.is_active();
        if is_level && is_usual {
            self.take_straight_trims(dt_s);
        }
    }

    fn take_straight_trims(&mut self, dt_s: f64) {
        let trims = Surfaces {
            throttle: self.loops.airspeed.trim(),
            ..self.loops.trims()
        };
        let airspeed_mps = self.estimator.estimate().airspeed_mps;
        self.loops.straight.take(&trims, airspeed_mps, dt_s);
    }

    /// The controls while nothing is heard. Near a runway, in a glide, and at another
    /// airspeed than that of the last straight and level flight, elevator and throttle
    /// are those of the present flight.
    pub(super) fn silent_trims(&self) -> Surfaces {
        let present = self.loops.trims();
        let straight = &self.loops.straight;
        if self.guidance.runway().is_some() {
            return present;
        }
        let trims = Surfaces {
            aileron: straight.aileron.output(),
            rudder: straight.rudder.output(),
            ..present
        };
        let airspeed_mps = self.estimator.estimate().airspeed_mps;
        if self.loops.glides || !straight.fits(airspeed_mps, present.elevator_trim) {
            return trims;
        }
        Surfaces {
            elevator: straight.elevator.output(),
            throttle: straight.throttle.output(),
            ..trims
        }
    }
}
