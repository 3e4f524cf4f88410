//! Attitude and body rates in flight, and which of them is doubted.

use core::time::Duration;

use super::motion_monitor::{MotionDoubt, MotionInput};
use super::motion_witness::WitnessInput;
use super::{Navigation, Quantities, Quantity};
use fcc_core::flight::Measurements;
use fcc_core::flight::atmosphere::true_airspeed_mps;
use fcc_core::flight::orientation::EulerAngles;
use fcc_core::framework::Time;

/// Attitude and body rates are compared if they are not older: of rates that are held for
/// longer the integral is too wrong.
const COMPARED: Duration = Duration::from_millis(200);

/// Whether what the air data are compared with is measured.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum KnownMotion {
    /// It is not measured.
    Unknown,
    /// It is measured, and the aircraft stands or rolls.
    OnWheels,
    /// It is measured, and the aircraft flies.
    InFlight,
}

impl Navigation {
    /// Compares attitude and body rates with each other in flight, before the tick's step;
    /// `lost` are the quantities that are lost for other reasons, `sigma_rad` is the standard
    /// deviation of an attitude that is computed.
    pub fn compare_motion(
        &mut self,
        now: Time,
        sensed: &Measurements,
        lost: Quantities,
        sigma_rad: f64,
        dt_s: f64,
    ) {
        let estimate = &self.estimate;
        let airspeed_mps =
            (!lost.contains(Quantity::Airspeed) && self.monitor.doubt().is_none()).then_some(
                true_airspeed_mps(sensed.airspeed_mps.value, estimate.altitude_m),
            );
        let is_measured = !lost.contains(Quantity::Attitude)
            && !lost.contains(Quantity::BodyRates)
            && sensed.attitude.is_fresh(now, COMPARED)
            && sensed.body_rates.is_fresh(now, COMPARED);
        let knows_climb = !lost.contains(Quantity::Altitude) && !self.altitude_monitor.is_doubted();
        let input = MotionInput {
            measured: is_measured.then_some((sensed.attitude.value, sensed.body_rates.value)),
            flown: EulerAngles {
                roll_rad: estimate.roll_rad,
                pitch_rad: estimate.pitch_rad,
                heading_rad: estimate.heading_rad,
            },
            witness: WitnessInput {
                forward_mps2: (!lost.contains(Quantity::SpecificForce))
                    .then_some(sensed.specific_force.value.x_mps2),
                heading_rad: (!lost.contains(Quantity::Heading))
                    .then_some(sensed.heading_rad.value),
                airspeed_mps,
                climb_rate_mps: knows_climb.then_some(estimate.climb_rate_mps),
                angle_of_attack_rad: estimate.angle_of_attack_rad,
                gusts_mps: self.monitor.gusts_mps(),
            },
            sigma_rad,
            may_doubt: self.is_engaged && !self.is_flaring,
        };
        if let Some(rotation) = self.motion.step(&input, dt_s) {
            self.attitude.adopt_gravity(rotation);
        }
    }

    /// The attitude so far was wrong: the next one is adopted.
    pub const fn adopt_next_attitude(&mut self) {
        self.attitude.adopt_next();
    }

    /// What is doubted of attitude and body rates, while it lasts.
    pub const fn motion_doubt(&self) -> Option<MotionDoubt> {
        self.motion.doubt()
    }

    /// Whether attitude and body rates contradict each other, and it is not decided yet.
    pub const fn suspects_motion(&self) -> bool {
        self.motion.suspects()
    }
}
