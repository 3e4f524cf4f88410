//! Sensor and actuator, a minimal X-Plane on the loopback interface, and a loop
//! between them.
//!
//! The loopback interface delivers before `send` returns, and the time of the
//! ticks is set by the test, so minutes of flight take milliseconds and nothing
//! depends on the speed of the machine.

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Sensor, SensorFault};
use fcc_xplane::{Control, XPlane, XPlaneActuator, XPlaneConfig, XPlaneSensor, XPlaneStatus};

use super::{
    FakeXPlane, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, Ticks, YOKE_HEADING, YOKE_PITCH, YOKE_ROLL,
};

pub const SURFACES: Surfaces = Surfaces {
    throttle: 0.8,
    elevator: 0.1,
    aileron: -0.2,
    rudder: 0.05,
    ..Surfaces::IDLE
};

/// Both ends and a loop between them.
pub struct Bench {
    pub simulator: FakeXPlane,
    pub sensor: XPlaneSensor,
    pub actuator: Option<XPlaneActuator>,
    pub status: XPlaneStatus,
    pub ticks: Ticks,
    pub measurements: Measurements,
}

impl Bench {
    pub fn new() -> Self {
        Self::with(|_| {})
    }

    pub fn with(change: impl FnOnce(&mut XPlaneConfig)) -> Self {
        Self::on(FakeXPlane::new(), change)
    }

    pub fn on(simulator: FakeXPlane, change: impl FnOnce(&mut XPlaneConfig)) -> Self {
        let mut config = simulator.config();
        change(&mut config);
        let (sensor, actuator) = XPlane::open(&config).unwrap();
        Self {
            simulator,
            status: sensor.status(),
            sensor,
            actuator: Some(actuator),
            ticks: Ticks::new(),
            measurements: Measurements::default(),
        }
    }

    pub fn sample(&mut self) -> Result<(), SensorFault> {
        let tick = self.ticks.next();
        self.sensor.sample(&tick, &mut self.measurements)
    }

    /// A tick in which the simulator runs and the loop only reads.
    pub fn watch(&mut self) -> Result<(), SensorFault> {
        self.simulator.live(0.025);
        self.sample()
    }

    /// A tick in which the loop also writes.
    pub fn fly(&mut self) -> Result<(), ActuatorFault> {
        self.fly_with(&SURFACES)
    }

    /// The same, with these surfaces.
    pub fn fly_with(&mut self, surfaces: &Surfaces) -> Result<(), ActuatorFault> {
        self.simulator.live(0.025);
        let tick = self.ticks.next();
        self.sensor.sample(&tick, &mut self.measurements).unwrap();
        self.actuator.as_mut().unwrap().apply(&tick, surfaces)
    }

    /// Reads until all subscriptions are active.
    pub fn settle(&mut self) {
        for _ in 0..8 {
            // It is silent in the first tick.
            let _ = self.watch();
        }
        self.watch().unwrap();
    }

    /// After a flight whose release X-Plane has confirmed.
    pub fn released() -> Self {
        let mut bench = Self::new();
        bench.settle();
        for _ in 0..40 {
            bench.fly().unwrap();
        }
        bench.actuator.as_mut().unwrap().release().unwrap();
        for _ in 0..40 {
            bench.watch().unwrap();
        }
        assert_eq!(bench.status.control(), Control::Free);
        assert!(bench.status.held_at().is_some(), "a write may be late");
        bench.simulator.writes.clear();
        bench
    }

    pub fn assert_released(&mut self) {
        self.simulator.writes.clear();
        self.simulator.listen();
        for path in [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES] {
            self.simulator.assert_shows(path, 0.0);
        }
        for path in [YOKE_PITCH, YOKE_ROLL, YOKE_HEADING] {
            self.simulator.assert_shows(path, 0.0);
        }
        // Three times, each time the surfaces before the overrides.
        let writes = &self.simulator.writes;
        assert_eq!(writes.len(), 15);
        for round in writes.chunks(5) {
            assert!(round[..3].iter().all(|(path, _)| path.contains("yoke_")));
            assert!(
                round[3..]
                    .iter()
                    .all(|(path, _)| path.contains("override_"))
            );
        }
    }
}

pub fn close(got: f64, expected: f64) {
    assert!((got - expected).abs() < 1e-6, "{got} is not {expected}");
}
