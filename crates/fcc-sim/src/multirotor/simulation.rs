//! A multicopter as the loop's sensor and actuator.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use fcc_core::flight::{Battery, MOST_ROTORS, Measurements, Motors, Plant, PlantState};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, Tick};

use super::body::Multirotor;
use super::frame::Frame;
use crate::aircraft::LONGEST_STEP_S;
use crate::config::{Channels, SensorConfig, SimConfig, SimError, SwitchScript};
use crate::link::{SharedState, SwitchHandle, TruthHandle};
use crate::sensing::{BuiltInRaw, History, Sensors};
use crate::truth::{HasTruth, Truth};

/// The configuration of a simulated multicopter.
#[derive(Clone, PartialEq, Debug)]
pub struct MultirotorConfig {
    /// The vehicle.
    pub frame: Frame,
    /// The world and the sensors. What belongs to an aeroplane is not used.
    pub world: SimConfig,
}

impl Default for MultirotorConfig {
    /// A quadrotor whose sensors have the noise of low-cost ones, and are 10 ms late.
    fn default() -> Self {
        Self {
            frame: Frame::quadrotor(),
            world: SimConfig {
                substep_s: 0.001,
                sensors: SensorConfig {
                    noise: Channels::TYPICAL_NOISE,
                    delay_ms: 10,
                    ..SensorConfig::default()
                },
                switch: SwitchScript {
                    on_at_s: Some(4.0),
                    off_at_s: None,
                },
                ..SimConfig::default()
            },
        }
    }
}

/// One simulated multicopter, in the parts for a loop and its observers.
#[derive(Debug)]
pub struct MultirotorSimulation {
    /// Owns the multicopter and advances it when sampled.
    pub sensor: MultirotorSensor,
    /// Drives its motors.
    pub actuator: MultirotorActuator,
    /// Sets the engage switch.
    pub switch: SwitchHandle,
    /// Reads the truth.
    pub truth: TruthHandle,
}

impl MultirotorSimulation {
    /// Builds a multicopter as configured, on the ground.
    ///
    /// # Errors
    /// [`SimError`] if a number is out of range.
    pub fn new(config: &MultirotorConfig) -> Result<Self, SimError> {
        let body = Multirotor::new(&config.frame, &config.world)?;
        let start = body.truth();
        let shared = Arc::new(SharedState::default());
        shared.publish(&start);
        let motors = Arc::new([const { AtomicU64::new(0) }; MOST_ROTORS]);
        Ok(Self {
            switch: SwitchHandle::new(Arc::clone(&shared)),
            truth: TruthHandle::new(Arc::clone(&shared)),
            actuator: MultirotorActuator(Arc::clone(&motors)),
            sensor: MultirotorSensor {
                body,
                sensors: Sensors::new(&config.world),
                history: History::new(config.world.sensors.delay_ms, &start),
                raw: BuiltInRaw::new(&config.world, &start),
                script: config.world.switch,
                motors,
                shared,
            },
        })
    }
}

/// The multicopter and its sensors: each sample advances it by the tick's time with the last
/// motor speeds, then measures.
#[derive(Debug)]
pub struct MultirotorSensor {
    body: Multirotor,
    sensors: Sensors,
    history: Option<History>,
    raw: Option<BuiltInRaw>,
    script: SwitchScript,
    /// Bits of the speeds.
    motors: Arc<[AtomicU64; MOST_ROTORS]>,
    shared: Arc<SharedState>,
}

impl MultirotorSensor {
    /// The multicopter, to be looked at or moved in an experiment.
    pub const fn body_mut(&mut self) -> &mut Multirotor {
        &mut self.body
    }
}

impl HasTruth for MultirotorSensor {
    fn truth(&self) -> Truth {
        self.body.truth()
    }
}

impl Sensor<Measurements> for MultirotorSensor {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let motors = self
            .motors
            .each_ref()
            .map(|place| f64::from_bits(place.load(Ordering::Relaxed)));
        let (history, raw) = (&mut self.history, &mut self.raw);
        self.body.step(&motors, tick.dt_s, |body| {
            if history.is_none() && raw.is_none() {
                return;
            }
            let truth = body.truth();
            if let Some(history) = history {
                history.store(&truth);
            }
            if let Some(raw) = raw {
                raw.step(&truth);
            }
        });
        let truth = self.body.truth();
        self.shared.publish(&truth);
        if let Some(at_s) = self.body.impact_s() {
            self.shared.hit_ground(at_s);
        }
        let taken = tick.woke;
        let measured = self.history.as_ref();
        let measured = measured.map_or(truth, |history| history.delayed(&truth));
        self.sensors.measure(&measured, taken, into);
        if let Some(raw) = &mut self.raw {
            raw.read(taken, into);
        }
        let battery = Battery {
            voltage_v: Some(self.body.battery().voltage_v()),
            charge: Some(self.body.battery().charge),
        };
        into.battery = Reading::new(battery, taken);
        let switch = self
            .shared
            .switch()
            .unwrap_or_else(|| self.script.position(truth.time_s));
        into.engage_switch = Reading::new(switch, taken);
        let state = if tick.dt_s > LONGEST_STEP_S {
            PlantState::Slow
        } else {
            PlantState::Running
        };
        let time_s = truth.time_s;
        into.plant = Reading::new(Plant { time_s, state }, taken);
        Ok(())
    }

    fn name(&self) -> &'static str {
        "built-in multicopter"
    }
}

/// The multicopter's motors. Released, they stop.
#[derive(Debug)]
pub struct MultirotorActuator(Arc<[AtomicU64; MOST_ROTORS]>);

impl Actuator<Motors> for MultirotorActuator {
    fn apply(&mut self, _: &Tick, motors: &Motors) -> Result<(), ActuatorFault> {
        for (place, speed) in self.0.iter().zip(motors.speeds()) {
            place.store(speed.unwrap_or(0.0).to_bits(), Ordering::Relaxed);
        }
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.apply(&Tick::default(), &Motors::default())
    }

    fn name(&self) -> &'static str {
        "built-in multicopter"
    }
}
