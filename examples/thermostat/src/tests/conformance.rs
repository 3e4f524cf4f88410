//! Runs the conformance suites for thermometer and heater.

use fcc_conformance::{ActuatorBench, SensorBench, actuator_conformance, sensor_conformance};
use fcc_core::framework::{Actuator, Sensor, Time};

use crate::room::{Heater, Thermometer};
use crate::values::{Heating, Measured};

struct Room {
    thermometer: Thermometer,
    heater: Heater,
}

fn room() -> Room {
    let heater = Heater::default();
    let thermometer = Thermometer {
        room_c: 12.0,
        heater: heater.clone(),
    };
    Room {
        thermometer,
        heater,
    }
}

impl SensorBench for Room {
    type Measurements = Measured;
    /// The thermometer computes the room, so there is always a new value.
    const MEASURES_UNASKED: bool = true;

    fn new() -> Self {
        room()
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measured> {
        &mut self.thermometer
    }

    fn provide(&mut self) {}

    fn taken(measured: &Measured) -> Vec<Time> {
        vec![measured.room_c.taken]
    }
}

impl ActuatorBench for Room {
    type Outputs = Heating;

    fn new() -> Self {
        room()
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Heating> {
        &mut self.heater
    }

    fn outputs(number: u32) -> Heating {
        Heating {
            power: f64::from(number % 10 + 1) * 0.1,
        }
    }

    fn is_held(&mut self) -> bool {
        self.thermometer.heater.power() > 0.0
    }

    fn follows(&mut self, heating: &Heating) -> bool {
        self.thermometer.heater.power() == heating.power
    }
}

sensor_conformance!(thermometer: Room);
actuator_conformance!(heater: Room);
