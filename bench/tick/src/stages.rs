//! The single stages of a tick, without a socket.

use std::collections::VecDeque;
use std::hint::black_box;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Controller, Message, MessageOf, RecordOf, Sensor, Tick};
use fcc_fixed_wing::{Autopilot, AutopilotConfig};
use fcc_navigation::inertial::{MagneticNorth, RawNavigationConfig};
use fcc_sim::{Channels, RawSensorSet, SensorConfig, Severity, SimConfig, Simulation};
use fcc_xplane::{Errno, Port, XPlane, XPlaneActuator, XPlaneSensor};
use rtrb::{Consumer, Producer, RingBuffer};
use std::net::SocketAddr;

use crate::support::{FLIGHT_TIME, FakeXPlane, Scripted, position_reply};
use crate::{Flight, PERIOD};

/// Half a minute of flight: sensors and actuator have settled, and what the
/// autopilot learns of the aircraft is known.
const WARM_UP_TICKS: u32 = 1_200;
/// The autopilot engages once the gyroscopes can be compared with the magnetic field,
/// which takes 20 s at most.
const ENGAGED_AT_TICK: u32 = 800;

/// The satellite receiver's is 120 ms.
const LONGEST_DELAY: Duration = Duration::from_millis(200);

/// The stages of a tick, to be called separately and in any order.
/// [`next`](Self::next) advances to the next tick.
///
/// What becomes of datagrams is measured by a simulated X-Plane whose values are
/// constant; the autopilot flies the built-in aircraft, in gusts, with noise and
/// 25 ms of delay, so that everything in it moves as in flight.
pub struct Stages {
    simulator: FakeXPlane,
    wire: Arc<Scripted>,
    sensor: XPlaneSensor<Wire>,
    actuator: XPlaneActuator<Wire>,
    autopilot: Autopilot,
    aircraft: Simulation,
    tick: Tick,
    measurements: Measurements,
    /// How many sets of the same sensors there are.
    sets: u8,
    sampled: Measurements,
    outputs: Surfaces,
    /// What of the tick has been computed.
    is_seen: bool,
    is_guided: bool,
    is_controlled: bool,
    record: RecordOf<Autopilot>,
    ring: (
        Producer<MessageOf<Autopilot>>,
        Consumer<MessageOf<Autopilot>>,
    ),
}

impl Stages {
    /// Of a loop that is engaged.
    ///
    /// # Panics
    /// When it cannot be assembled.
    pub fn engaged() -> Self {
        Self::flying_by(None)
    }

    /// The same; attitude is computed from the raw sensors of a present board.
    ///
    /// # Panics
    /// When it cannot be assembled.
    pub fn engaged_by_raw_sensors() -> Self {
        Self::flying_by(Some(&RawSensorSet::board()))
    }

    /// The same, with two sets of them that agree.
    ///
    /// # Panics
    /// When it cannot be assembled.
    pub fn engaged_by_two_sets() -> Self {
        let mut stages = Self::engaged_by_raw_sensors();
        stages.sets = 2;
        stages
    }

    fn flying_by(raw_sensors: Option<&RawSensorSet>) -> Self {
        let flight = Flight::engaged();
        let simulator = flight.simulator;
        let config = simulator.config();
        let wire = Arc::new(Scripted {
            from: simulator.address(),
            datagrams: Mutex::new(VecDeque::new()),
        });
        let (sensor, actuator) =
            XPlane::over(&config, Wire(Arc::clone(&wire)), None).expect("a fair configuration");
        let record = *flight.machine.record();
        let aircraft = SimConfig {
            gusts: Some(Severity::Moderate),
            sensors: SensorConfig {
                noise: Channels::TYPICAL_NOISE,
                delay_ms: 25,
                ..SensorConfig::default()
            },
            raw_sensors: raw_sensors.copied(),
            ..SimConfig::default()
        };
        let raw_navigation = aircraft.raw_sensors.is_some().then(|| RawNavigationConfig {
            delay: LONGEST_DELAY,
            north: MagneticNorth::Field(aircraft.magnetic_field_ut()),
        });
        let config = AutopilotConfig {
            raw_navigation,
            ..AutopilotConfig::default()
        };
        let mut stages = Self {
            simulator,
            wire,
            sensor,
            actuator,
            autopilot: Autopilot::new(config),
            aircraft: Simulation::new(&aircraft).expect("a fair configuration"),
            tick: record.tick,
            measurements: Measurements::default(),
            sets: 1,
            sampled: record.measurements,
            outputs: Surfaces::default(),
            is_seen: true,
            is_guided: true,
            is_controlled: true,
            record,
            ring: RingBuffer::new(16),
        };
        for _ in 0..ENGAGED_AT_TICK {
            stages.next();
            stages.navigation();
            (stages.is_guided, stages.is_controlled) = (true, true);
        }
        let inhibits = stages
            .autopilot
            .engage_inhibits(&stages.tick, &stages.measurements);
        assert!(inhibits.is_empty(), "does not engage: {inhibits:?}");
        stages.autopilot.engage(&stages.tick, &stages.measurements);
        for _ in 0..WARM_UP_TICKS {
            stages.next();
            stages.sensors();
            stages.step();
            stages.actuators();
            stages.record();
        }
        stages
    }

    /// Advances to the next tick: what of this one is left is computed, time
    /// passes, the aircraft flies, a frame arrives, the ring is emptied.
    ///
    /// # Panics
    /// Not unless another thread has.
    pub fn next(&mut self) {
        if !self.is_seen {
            self.navigation();
        }
        if !self.is_guided {
            self.guidance();
        }
        if !self.is_controlled {
            self.control();
        }
        (self.is_seen, self.is_guided, self.is_controlled) = (false, false, false);
        self.tick.number += 1;
        self.tick.scheduled = self.tick.scheduled + PERIOD;
        self.tick.woke = self.tick.woke + PERIOD;
        let Simulation {
            sensor, actuator, ..
        } = &mut self.aircraft;
        let applied = actuator.apply(&self.tick, &self.outputs);
        let sampled = sensor.sample(&self.tick, &mut self.measurements);
        assert!(applied.is_ok() && sampled.is_ok(), "flies no longer");

        let time = self.simulator.value(FLIGHT_TIME) + PERIOD.as_secs_f32();
        self.simulator.set(FLIGHT_TIME, time);
        let mut datagrams = self.wire.datagrams.lock().expect("one thread");
        datagrams.clear();
        datagrams.push_back(self.simulator.frame());
        datagrams.push_back(position_reply(self.simulator.position));
        drop(datagrams);
        while self.ring.1.pop().is_ok() {}
    }

    /// The same, and the measurements become position and motion.
    pub fn next_seen(&mut self) {
        self.next();
        self.navigation();
    }

    /// The same, and set points.
    pub fn next_guided(&mut self) {
        self.next_seen();
        self.guidance();
    }

    /// A frame's datagrams become measurements.
    #[inline(never)]
    pub fn sensors(&mut self) {
        // The result is not used.
        let _ = black_box(self.sensor.sample(&self.tick, &mut self.sampled));
    }

    /// Measurements become position and motion.
    #[inline(never)]
    pub fn navigation(&mut self) {
        if self.sets > 1 {
            for sensor in 0..self.sets {
                self.autopilot
                    .observe_sensor(sensor, black_box(&self.measurements));
                black_box(self.autopilot.plausible(sensor, &self.measurements));
            }
        }
        self.autopilot
            .estimate(&self.tick, black_box(&self.measurements));
        self.is_seen = true;
    }

    /// Set points.
    #[inline(never)]
    pub fn guidance(&mut self) {
        self.autopilot
            .guide(&self.tick, black_box(&self.measurements));
        self.is_guided = true;
    }

    /// Surfaces and throttle, and whether they are valid.
    #[inline(never)]
    pub fn control(&mut self) {
        self.outputs = self
            .autopilot
            .control(&self.tick, black_box(&self.measurements));
        black_box(self.autopilot.outputs_are_valid(&self.outputs));
        self.is_controlled = true;
    }

    /// From measurements to surfaces and throttle.
    #[inline(never)]
    pub fn step(&mut self) {
        self.navigation();
        self.guidance();
        self.control();
    }

    /// They become datagrams.
    #[inline(never)]
    pub fn actuators(&mut self) {
        let _ = black_box(self.actuator.apply(&self.tick, &self.outputs));
    }

    /// The record goes into the ring.
    #[inline(never)]
    pub fn record(&mut self) {
        self.record.measurements = self.measurements;
        self.record.tick = self.tick;
        let pushed = self.ring.0.push(Message::Tick(black_box(self.record)));
        black_box(pushed.is_ok());
    }
}

/// The wire that sensor and actuator share.
struct Wire(Arc<Scripted>);

impl Port for Wire {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        self.0.receive(into)
    }

    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno> {
        self.0.send(black_box(datagram), to)
    }
}
