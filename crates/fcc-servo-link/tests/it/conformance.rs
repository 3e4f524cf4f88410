//! The servo board's sensor and actuator conform to the traits, over a serial
//! line that is pulled out and put back, and over UDP.

use crate::support::{Bench, SerialLine, Udp, Way};
use fcc_conformance::{
    ActuatorBench, SensorBench, VanishingPlant, VanishingSource, actuator_conformance,
    sensor_conformance,
};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick, Time};

impl<W: Way> SensorBench for Bench<W> {
    type Measurements = Measurements;
    /// Ten requests in two portions, and the reply.
    const CONNECTED_AFTER: usize = 4;

    fn new() -> Self {
        Self::open()
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        self.sensor.as_mut()
    }

    fn provide(&mut self) {
        self.live();
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        vec![
            measured.airspeed_mps.taken,
            measured.differential_pressure_pa.taken,
            measured.engage_switch.taken,
            measured.surfaces.taken,
        ]
    }
}

impl<W: Way> VanishingSource for Bench<W> {
    /// 500 ms.
    const PATIENCE: usize = 20;
    /// What was silent is asked again once a second.
    const BACK_AFTER: usize = 85;

    fn vanish(&mut self) {
        self.way.pull();
    }

    fn come_back(&mut self) {
        self.way.put_back();
    }
}

impl<W: Way> ActuatorBench for Bench<W> {
    type Outputs = Surfaces;

    fn new() -> Self {
        Self::open()
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        self.actuator.as_mut()
    }

    fn outputs(number: u32) -> Surfaces {
        let share = f64::from(number % 8 + 1) * 0.125;
        Surfaces {
            throttle: share,
            elevator: share,
            aileron: -share,
            rudder: 0.5 * share,
            flaps: Some(0.5),
            left_brake: Some(0.25),
            right_brake: Some(0.125),
            gear: Some(1.0),
            ..Surfaces::IDLE
        }
    }

    fn live(&mut self, tick: &Tick) {
        Self::live(self);
        let _ = self.sensor.sample(tick, &mut self.measured);
    }

    fn is_held(&mut self) -> bool {
        Self::is_held(self)
    }

    fn follows(&mut self, outputs: &Surfaces) -> bool {
        Self::follows(self, outputs)
    }

    fn messages(&mut self) -> u64 {
        self.receive();
        self.messages
    }
}

impl<W: Way> VanishingPlant for Bench<W> {
    /// Unconfirmed for a second, and the readback before it.
    const PATIENCE: usize = 61;
    /// Two seconds, until values are asked again and agree.
    const BACK_AFTER: usize = 85;

    fn vanish(&mut self) {
        self.way.pull();
    }

    fn come_back(&mut self) {
        self.way.put_back();
    }
}

sensor_conformance!(serial_sensor: Bench<SerialLine>, vanishes);
actuator_conformance!(serial_actuator: Bench<SerialLine>, vanishes);
sensor_conformance!(udp_sensor: Bench<Udp>, vanishes);
actuator_conformance!(udp_actuator: Bench<Udp>, vanishes);
