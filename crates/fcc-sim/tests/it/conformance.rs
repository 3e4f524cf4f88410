//! The built-in aircraft conforms to the traits.

use fcc_conformance::{
    ActuatorBench, SensorBench, actuator_conformance, flight_times, sensor_conformance,
};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick, Time};
use fcc_sim::{Channels, SensorConfig, Severity, SimConfig, Simulation};

struct Bench {
    simulation: Simulation,
    measured: Measurements,
}

/// With everything that makes a sample more expensive.
fn new() -> Bench {
    let config = SimConfig {
        gusts: Some(Severity::Moderate),
        sensors: SensorConfig {
            noise: Channels::TYPICAL_NOISE,
            bias: Channels::TYPICAL_NOISE,
            resolution: Channels::TYPICAL_NOISE,
            delay_ms: 100,
        },
        ..SimConfig::default()
    };
    Bench {
        simulation: Simulation::new(&config).unwrap(),
        measured: Measurements::default(),
    }
}

impl SensorBench for Bench {
    type Measurements = Measurements;
    const MEASURES_UNASKED: bool = true;

    fn new() -> Self {
        new()
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.simulation.sensor
    }

    fn provide(&mut self) {}

    fn taken(measured: &Measurements) -> Vec<Time> {
        flight_times(measured)
    }
}

impl ActuatorBench for Bench {
    type Outputs = Surfaces;

    fn new() -> Self {
        new()
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        &mut self.simulation.actuator
    }

    fn outputs(number: u32) -> Surfaces {
        Surfaces {
            throttle: 0.7,
            elevator: 0.01,
            aileron: f64::from(number % 8) * 0.01 + 0.01,
            rudder: -0.01,
            ..Surfaces::IDLE
        }
    }

    /// Advances, under what was applied before.
    fn live(&mut self, tick: &Tick) {
        let sensor = &mut self.simulation.sensor;
        sensor.sample(tick, &mut self.measured).unwrap();
    }

    /// Released surfaces are those of the trim, from which all outputs differ.
    fn is_held(&mut self) -> bool {
        self.measured_surfaces() != self.simulation.sensor.aircraft().hands_off()
    }

    fn follows(&mut self, outputs: &Surfaces) -> bool {
        self.measured_surfaces() == *outputs
    }
}

impl Bench {
    /// The positions of the controls, as the next sample measures them; that
    /// sample takes no simulated time.
    fn measured_surfaces(&mut self) -> Surfaces {
        let tick = Tick::default();
        let sensor = &mut self.simulation.sensor;
        sensor.sample(&tick, &mut self.measured).unwrap();
        self.measured.surfaces.value
    }
}

sensor_conformance!(sensor: Bench);
actuator_conformance!(actuator: Bench);
