//! The controller: heats the room to its set point.

use std::time::Duration;

use fcc_core::blocks::{Pid, PidConfig};
use fcc_core::framework::schema::in_range;
use fcc_core::framework::{Controller, Flags, Tick};
use serde::{Deserialize, Serialize};

use crate::room::{HEATER_W, RESISTANCE_K_PER_W, TIME_CONSTANT_S, TIME_SCALE};
use crate::values::{Heating, Measured, Wanted};

const MAX_AGE: Duration = Duration::from_secs(1);
const NO_TEMPERATURE: Flags = Flags::bit(0);

/// The configuration; each recording has it, as TOML.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Config {
    /// How warm the room is to be in the beginning.
    pub(crate) wanted_c: f64,
    /// How fast the room is to follow, s of its own time.
    pub(crate) response_s: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            wanted_c: 20.0,
            response_s: 600.0,
        }
    }
}

pub(crate) struct Thermostat {
    wanted_c: f64,
    pid: Pid,
}

impl Thermostat {
    pub(crate) fn new(config: &Config) -> Self {
        let Config {
            wanted_c,
            response_s,
        } = *config;
        // Both poles of the closed loop at 1/response_s (pole placement for
        // a first-order plant: Åström and Hägglund 1995, chapter 4).
        let gain_k = RESISTANCE_K_PER_W * HEATER_W;
        let pole_per_s = 1.0 / response_s;
        let pid = Pid::new(PidConfig {
            kp: (2.0 * pole_per_s * TIME_CONSTANT_S - 1.0) / gain_k,
            ki: pole_per_s * pole_per_s * TIME_CONSTANT_S / gain_k,
            output_min: 0.0,
            output_max: 1.0,
            ..PidConfig::default()
        });
        Self { wanted_c, pid }
    }
}

impl Controller for Thermostat {
    type Measurements = Measured;
    type Estimate = ();
    type Setpoints = Wanted;
    type Outputs = Heating;
    /// Another set point, °C.
    type Command = f64;

    fn estimate(&mut self, _: &Tick, _: &Measured) {}

    fn engage_inhibits(&self, tick: &Tick, measured: &Measured) -> Flags {
        let known = measured.room_c.is_fresh(tick.woke, MAX_AGE);
        Flags::NONE.with(NO_TEMPERATURE, !known)
    }

    fn faults(&self, tick: &Tick, measured: &Measured) -> Flags {
        self.engage_inhibits(tick, measured)
    }

    fn flag_name(_: u32) -> &'static str {
        "the temperature is not known"
    }

    fn engage(&mut self, _: &Tick, measured: &Measured) {
        let room_c = measured.room_c.value;
        self.pid.engage(0.0, room_c, room_c, 0.0, 1.0);
    }

    fn control(&mut self, tick: &Tick, measured: &Measured) -> Heating {
        let dt_s = tick.dt_s * TIME_SCALE;
        Heating {
            power: self.pid.step(self.wanted_c, measured.room_c.value, dt_s),
        }
    }

    /// Off: a cold room is safer than a burnt one.
    fn failsafe(&mut self, _: &Tick, _: &Measured) -> Heating {
        Heating { power: 0.0 }
    }

    fn command(&mut self, wanted_c: &f64) {
        self.wanted_c = *wanted_c;
    }

    fn setpoints(&self) -> Wanted {
        Wanted {
            room_c: self.wanted_c,
        }
    }

    fn outputs_are_valid(&self, heating: &Heating) -> bool {
        in_range(heating)
    }
}
