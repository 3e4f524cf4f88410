//! X-Plane's sensor and actuator conform to the traits, with both kinds of
//! input and both kinds of output, against a minimal X-Plane on a loopback
//! socket.

use std::thread;
use std::time::Duration;

use crate::support::{
    FLIGHT_TIME, FakeXPlane, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, THROTTLE, YOKE_HEADING,
    YOKE_PITCH, YOKE_ROLL, free_port,
};
use fcc_conformance::{
    ActuatorBench, AuthorityBench, SensorBench, VanishingPlant, VanishingSource,
    actuator_conformance, authority_conformance, flight_times, sensor_conformance,
};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, ControlAuthority, PlantId, Released, Sensor, Tick, Time};
use fcc_xplane::{
    DataRows, Input, Output, RowsVersion, XPlane, XPlaneActuator, XPlaneAuthority, XPlaneConfig,
    XPlaneSensor,
};

/// A simulator, and both ends of a connection to it.
struct Plane {
    simulator: FakeXPlane,
    sensor: XPlaneSensor,
    actuator: XPlaneActuator,
    authority: XPlaneAuthority,
    measured: Measurements,
    /// Where the rows of Data Output go, if they are the input.
    rows_to: Option<u16>,
    /// Nothing is transmitted, in either direction.
    cut_off: bool,
}

impl Plane {
    fn with(input: Way, output: Output) -> Self {
        let simulator = FakeXPlane::new();
        let mut config = XPlaneConfig {
            output,
            ..simulator.config()
        };
        let mut rows_to = None;
        if let Way::Rows(version) = input {
            let port = free_port();
            config.local_port = port;
            config.input = Input::Data(DataRows::of(version));
            rows_to = Some(port);
        }
        let (sensor, actuator) = XPlane::open(&config).unwrap();
        Self {
            simulator,
            authority: XPlaneAuthority::of(sensor.status(), &config),
            sensor,
            actuator,
            measured: Measurements::default(),
            rows_to,
            cut_off: false,
        }
    }

    /// The simulator reads what arrived, and sends a frame.
    fn frame(&mut self) {
        if self.cut_off {
            self.lose();
            return;
        }
        self.simulator.live(0.025);
        if let Some(port) = self.rows_to {
            self.simulator.send_rows(port);
        }
    }

    /// Discards what was sent.
    fn lose(&mut self) {
        let mut buffer = [0; 2_048];
        while self.simulator.socket.recv_from(&mut buffer).is_ok() {}
    }
}

/// How measurements are received.
#[derive(Clone, Copy)]
enum Way {
    Values,
    Rows(RowsVersion),
}

trait Case: Send {
    const INPUT: Way;
    const OUTPUT: Output;
}

struct Rref;

impl Case for Rref {
    const INPUT: Way = Way::Values;
    const OUTPUT: Output = Output::Dref;
}

struct Rows;

impl Case for Rows {
    const INPUT: Way = Way::Rows(RowsVersion::XPlane12);
    const OUTPUT: Output = Output::Data;
}

struct Bench<C: Case>(Plane, core::marker::PhantomData<C>);

impl<C: Case> Bench<C> {
    fn of_case() -> Self {
        Self(Plane::with(C::INPUT, C::OUTPUT), core::marker::PhantomData)
    }
}

impl<C: Case> SensorBench for Bench<C> {
    type Measurements = Measurements;
    /// Four ticks of eight requests each.
    const CONNECTED_AFTER: usize = 8;

    fn new() -> Self {
        Self::of_case()
    }

    fn sensor(&mut self) -> &mut dyn Sensor<Measurements> {
        &mut self.0.sensor
    }

    fn provide(&mut self) {
        self.0.frame();
    }

    fn taken(measured: &Measurements) -> Vec<Time> {
        flight_times(measured)
    }
}

/// Killed and started again: it has no subscriptions and another flight.
impl<C: Case> VanishingSource for Bench<C> {
    /// Half a second, by default.
    const PATIENCE: usize = 20;
    /// Everything is requested again every five seconds, by default.
    const BACK_AFTER: usize = 210;

    fn vanish(&mut self) {
        self.0.cut_off = true;
        self.0.simulator.restart();
    }

    fn come_back(&mut self) {
        self.0.lose();
        self.0.cut_off = false;
        self.0.simulator.set(FLIGHT_TIME, 0.0);
    }
}

impl<C: Case> ActuatorBench for Bench<C> {
    type Outputs = Surfaces;

    fn new() -> Self {
        Self::of_case()
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        &mut self.0.actuator
    }

    fn outputs(number: u32) -> Surfaces {
        let step = f64::from(number % 16) * 0.03125 + 0.03125;
        Surfaces {
            throttle: step,
            elevator: -step,
            aileron: step,
            rudder: -step,
            ..Surfaces::IDLE
        }
    }

    fn live(&mut self, tick: &Tick) {
        self.0.frame();
        let _ = self.0.sensor.sample(tick, &mut self.0.measured);
    }

    fn is_held(&mut self) -> bool {
        let simulator = &mut self.0.simulator;
        simulator.listen();
        [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES]
            .iter()
            .any(|path| simulator.value(path) >= 0.5)
    }

    fn follows(&mut self, outputs: &Surfaces) -> bool {
        let simulator = &mut self.0.simulator;
        simulator.listen();
        [
            (YOKE_PITCH, outputs.elevator),
            (YOKE_ROLL, outputs.aileron),
            (YOKE_HEADING, outputs.rudder),
            (THROTTLE, outputs.throttle),
        ]
        .iter()
        .all(|(path, written)| f64::from(simulator.value(path)) == *written)
    }

    fn messages(&mut self) -> u64 {
        self.0.simulator.listen();
        self.0.simulator.writes.len() as u64
    }
}

/// A pulled cable: the simulator continues with the last commands it received.
impl<C: Case> VanishingPlant for Bench<C> {
    /// A second until writing counts as without effect, and the age of the last
    /// readback.
    const PATIENCE: usize = 61;
    /// Half a second until the readback agrees, and a sensor that requests
    /// again every five.
    const BACK_AFTER: usize = 210;

    fn vanish(&mut self) {
        self.0.cut_off = true;
    }

    fn come_back(&mut self) {
        self.0.lose();
        self.0.cut_off = false;
    }
}

impl<C: Case> AuthorityBench for Bench<C> {
    fn authority(&self) -> &dyn ControlAuthority {
        &self.0.authority
    }

    fn release_from_outside(&mut self, plant: &PlantId) -> Released {
        let plane = &mut self.0;
        let Plane {
            authority,
            simulator,
            ..
        } = plane;
        thread::scope(|scope| {
            let release =
                scope.spawn(|| authority.release(plant, Duration::from_secs(60), &mut || false));
            while !release.is_finished() {
                simulator.live(0.002);
                thread::sleep(Duration::from_millis(2));
            }
            release.join().unwrap().unwrap()
        })
    }
}

sensor_conformance!(rref: Bench<Rref>, vanishes);
sensor_conformance!(rows: Bench<Rows>, vanishes);
actuator_conformance!(dref: Bench<Rref>, vanishes);
actuator_conformance!(data: Bench<Rows>, vanishes);
authority_conformance!(authority_dref: Bench<Rref>);
authority_conformance!(authority_data: Bench<Rows>);
