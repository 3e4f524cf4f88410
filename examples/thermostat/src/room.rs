//! A simulated room with a thermometer and a heater: the plant.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, Tick};

use crate::values::{Heating, Measured};

/// How much faster time passes in the room: 1.8 s for an hour.
pub(crate) const TIME_SCALE: f64 = 2_000.0;
/// Heat capacity of the room's air, furniture and inner walls, J/K.
const HEAT_CAPACITY_J_PER_K: f64 = 360_000.0;
/// Thermal resistance of its walls, K/W: 50 W are lost per degree.
pub(crate) const RESISTANCE_K_PER_W: f64 = 0.02;
pub(crate) const OUTSIDE_C: f64 = 2.0;
pub(crate) const HEATER_W: f64 = 2_000.0;
/// Time constant of the room, s: resistance times heat capacity.
pub(crate) const TIME_CONSTANT_S: f64 = RESISTANCE_K_PER_W * HEAT_CAPACITY_J_PER_K;

/// The heater, 0 off ..= 1 full. Its power is an atomic number, so that neither
/// side waits for the other.
#[derive(Clone, Default)]
pub(crate) struct Heater(Arc<AtomicU64>);

impl Heater {
    pub(crate) fn power(&self) -> f64 {
        f64::from_bits(self.0.load(Ordering::Relaxed))
    }

    fn set(&self, power: f64) {
        self.0.store(power.to_bits(), Ordering::Relaxed);
    }
}

impl Actuator<Heating> for Heater {
    fn apply(&mut self, _: &Tick, heating: &Heating) -> Result<(), ActuatorFault> {
        self.set(heating.power);
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.set(0.0);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "heater"
    }
}

/// The thermometer and the room.
pub(crate) struct Thermometer {
    pub(crate) room_c: f64,
    pub(crate) heater: Heater,
}

impl Thermometer {
    /// Advances the time. One heat capacity behind one resistance,
    /// `C dT/dt = P - (T - T_outside)/R` (lumped capacitance; Incropera et al.,
    /// Fundamentals of Heat and Mass Transfer, 2007, section 5.1), solved for
    /// constant power.
    pub(crate) fn pass(&mut self, seconds: f64) {
        let steady_c = OUTSIDE_C + RESISTANCE_K_PER_W * HEATER_W * self.heater.power();
        self.room_c = steady_c + (self.room_c - steady_c) * (-seconds / TIME_CONSTANT_S).exp();
    }
}

impl Sensor<Measured> for Thermometer {
    fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
        self.pass(tick.dt_s * TIME_SCALE);
        into.room_c = Reading::new(self.room_c, tick.woke);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "thermometer"
    }
}
