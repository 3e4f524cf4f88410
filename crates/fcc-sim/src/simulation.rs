//! The simulated aircraft as the loop's sensor and actuator.

use std::sync::Arc;

use fcc_core::flight::{Battery, Measurements, Plant, PlantState, Surfaces};
use fcc_core::framework::{Actuator, ActuatorFault, Reading, Sensor, SensorFault, Switch, Tick};

use libm::cos;

use crate::aircraft::Aircraft;
use crate::config::{SimConfig, SimError, SwitchScript};
use crate::link::{SharedState, SwitchHandle, TruthHandle};
use crate::sensing::{BuiltInRaw, History, Sensors};
use crate::trim::Trim;
use crate::truth::{HasTruth, Truth};

/// Beyond this the range finder gives nothing, m.
const LONGEST_RANGE_M: f64 = 40.0;

/// One simulated aircraft, in the parts for a loop and its observers.
#[derive(Debug)]
pub struct Simulation {
    /// Owns the aircraft and advances it when sampled.
    pub sensor: SimSensor,
    /// Moves the aircraft's controls.
    pub actuator: SimActuator,
    /// Sets the engage switch.
    pub switch: SwitchHandle,
    /// Reads the truth.
    pub truth: TruthHandle,
    /// The trim that the flight begins with.
    pub trim: Trim,
}

impl Simulation {
    /// Builds an aircraft as configured.
    ///
    /// # Errors
    /// [`SimError`] if a number is out of range or there is no trim.
    pub fn new(config: &SimConfig) -> Result<Self, SimError> {
        let aircraft = Aircraft::new(config)?;
        let start = aircraft.truth();
        let trim = *aircraft.trim();
        let link = Arc::new(SharedState::default());
        link.publish(&start);
        Ok(Self {
            switch: SwitchHandle::new(Arc::clone(&link)),
            truth: TruthHandle::new(Arc::clone(&link)),
            actuator: SimActuator {
                link: Arc::clone(&link),
            },
            sensor: SimSensor {
                aircraft,
                sensors: Sensors::new(config),
                history: History::new(config.sensors.delay_ms, &start),
                raw: BuiltInRaw::new(config, &start),
                script: config.switch,
                link,
            },
            trim,
        })
    }
}

/// The aircraft and its sensors: each sample advances it by the tick's time
/// under the last commands, then measures.
///
/// Simulated time follows the ticks, so that the same simulation runs in real
/// time under a loop's timer and in lockstep as fast as it computes. A late
/// tick, or one after missed periods, advances by the time that actually
/// passed, up to [`LONGEST_STEP_S`](crate::LONGEST_STEP_S); beyond that the
/// plant's state is `Slow`.
#[derive(Debug)]
pub struct SimSensor {
    aircraft: Aircraft,
    sensors: Sensors,
    history: Option<History>,
    raw: Option<BuiltInRaw>,
    script: SwitchScript,
    link: Arc<SharedState>,
}

impl SimSensor {
    /// The aircraft in its present state.
    pub fn aircraft(&self) -> &Aircraft {
        &self.aircraft
    }

    /// The same, to be moved in an experiment.
    pub fn aircraft_mut(&mut self) -> &mut Aircraft {
        &mut self.aircraft
    }

    fn switch(&self) -> Switch {
        let scripted = || self.script.position(self.aircraft.time_s());
        self.link.switch().unwrap_or_else(scripted)
    }
}

impl HasTruth for SimSensor {
    fn truth(&self) -> Truth {
        self.aircraft.truth()
    }
}

impl Sensor<Measurements> for SimSensor {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        let commands = self
            .link
            .commands()
            .unwrap_or_else(|| self.aircraft.hands_off());
        let (history, raw) = (&mut self.history, &mut self.raw);
        let passed_s = self
            .aircraft
            .step_watched(&commands, tick.dt_s, |aircraft| {
                if history.is_none() && raw.is_none() {
                    return;
                }
                let truth = aircraft.truth();
                if let Some(history) = history {
                    history.store(&truth);
                }
                if let Some(raw) = raw {
                    raw.step(&truth);
                }
            });
        if self.aircraft.has_diverged() {
            return Err(SensorFault::Silent);
        }
        let truth = self.aircraft.truth();
        self.link.publish(&truth);
        if let Some(at_s) = self.aircraft.impact_s() {
            self.link.hit_ground(at_s);
        }

        let taken = tick.woke;
        let measured = self
            .history
            .as_ref()
            .map_or(truth, |history| history.delayed(&truth));
        self.sensors.measure(&measured, taken, into);
        let height_m = self.aircraft.height_m();
        let down = cos(truth.pitch_rad) * cos(truth.roll_rad);
        if height_m < LONGEST_RANGE_M * down {
            into.range_m = Reading::new(height_m.max(0.0) / down, taken);
        }
        let weight = f64::from(u8::from(self.aircraft.on_wheels()));
        into.weight_on_wheels = Reading::new(weight, taken);
        into.engine_speed_radps = Reading::new(self.aircraft.engine_speed_radps(), taken);
        let battery = self.aircraft.battery();
        into.battery = Reading::new(
            Battery {
                voltage_v: Some(battery.voltage_v()),
                charge: Some(battery.charge()),
            },
            taken,
        );
        if let Some(raw) = &mut self.raw {
            raw.read(taken, into);
        }
        into.surfaces = Reading::new(commands, taken);
        into.engage_switch = Reading::new(self.switch(), taken);
        let state = if passed_s < tick.dt_s {
            PlantState::Slow
        } else {
            PlantState::Running
        };
        into.plant = Reading::new(
            Plant {
                time_s: truth.time_s,
                state,
            },
            taken,
        );
        Ok(())
    }

    fn name(&self) -> &'static str {
        "built-in aircraft"
    }
}

/// The aircraft's controls. When released, surfaces and throttle go to where
/// they were at the start, as with hands off the controls, and nothing levels the
/// wings; the elevator's trim stays where it is.
#[derive(Debug)]
pub struct SimActuator {
    link: Arc<SharedState>,
}

impl Actuator<Surfaces> for SimActuator {
    fn apply(&mut self, _tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        self.link.command(outputs);
        Ok(())
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.link.release();
        Ok(())
    }

    fn name(&self) -> &'static str {
        "built-in aircraft"
    }
}
