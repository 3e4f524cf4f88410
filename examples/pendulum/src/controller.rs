//! The controller: holds a pendulum upright by the torque of a motor.

use std::time::Duration;

use fcc_core::blocks::{Pid, PidConfig};
use fcc_core::framework::schema::in_range;
use fcc_core::framework::{Controller, Flags, Reading, Tick};
use fcc_core::schema;
use fcc_record::Recorded;
use fcc_telemetry::Telemetry;

schema! {
    /// The measurements of a pendulum.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Measured {
        /// From upright, positive to the right.
        #[field(1)]
        pub(crate) angle_rad: Reading<f64>,
        /// Turn rate.
        #[field(2)]
        pub(crate) rate_radps: Reading<f64>,
    }
}

fcc_core::readings!(Measured {
    angle_rad: "angle",
    rate_radps: "rate",
});

schema! {
    /// The set points of a pendulum.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Wanted {
        /// From upright, positive to the right.
        #[field(1)]
        pub(crate) angle_rad: f64,
    }
}

schema! {
    /// The output to the motor.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Motor {
        /// Torque, positive to the right.
        #[field(1, range = -2.0..=2.0)]
        pub(crate) torque_nm: f64,
    }
}

/// Mass times length squared: 0.2 kg at 0.5 m.
const INERTIA_KGM2: f64 = 0.05;
const GRAVITY_PER_LENGTH_PER_S2: f64 = 9.81 / 0.5;
/// All three poles of the closed loop, 1/s.
const POLE_PER_S: f64 = 6.0;
const MAX_AGE: Duration = Duration::from_millis(50);
const NO_ANGLE: Flags = Flags::bit(0);

/// Balances a pendulum.
pub(crate) struct Balance {
    wanted_rad: f64,
    pid: Pid,
}

impl Default for Balance {
    /// Pole placement for `θ'' = g/l θ + τ/(m l²)` (Åström and Hägglund 1995,
    /// chapter 4): `(s + p)³ = s³ + kd s² + (kp - g/l) s + ki`, times `m l²`.
    fn default() -> Self {
        let p = POLE_PER_S;
        let pid = Pid::new(PidConfig {
            kp: INERTIA_KGM2 * (3.0 * p * p + GRAVITY_PER_LENGTH_PER_S2),
            ki: INERTIA_KGM2 * p * p * p,
            kd: INERTIA_KGM2 * 3.0 * p,
            output_min: -2.0,
            output_max: 2.0,
            ..PidConfig::default()
        });
        Self {
            wanted_rad: 0.0,
            pid,
        }
    }
}

impl Controller for Balance {
    type Measurements = Measured;
    type Estimate = ();
    type Setpoints = Wanted;
    type Outputs = Motor;
    /// Another angle, rad.
    type Command = f64;

    fn estimate(&mut self, _: &Tick, _: &Measured) {}

    fn engage_inhibits(&self, tick: &Tick, measured: &Measured) -> Flags {
        let is_known = measured.angle_rad.is_fresh(tick.woke, MAX_AGE);
        Flags::NONE.with(NO_ANGLE, !is_known)
    }

    fn faults(&self, tick: &Tick, measured: &Measured) -> Flags {
        self.engage_inhibits(tick, measured)
    }

    fn flag_name(_: u32) -> &'static str {
        "the angle is missing or too old"
    }

    fn engage(&mut self, _: &Tick, measured: &Measured) {
        let angle_rad = measured.angle_rad.value;
        self.pid.engage(0.0, angle_rad, angle_rad, 0.0, 1.0);
    }

    fn control(&mut self, tick: &Tick, measured: &Measured) -> Motor {
        let angle_rad = measured.angle_rad.value;
        Motor {
            torque_nm: self.pid.step(self.wanted_rad, angle_rad, tick.dt_s),
        }
    }

    /// No torque: it falls, as without a motor.
    fn failsafe(&mut self, _: &Tick, _: &Measured) -> Motor {
        Motor::default()
    }

    fn command(&mut self, wanted_rad: &f64) {
        self.wanted_rad = *wanted_rad;
    }

    fn setpoints(&self) -> Wanted {
        Wanted {
            angle_rad: self.wanted_rad,
        }
    }

    fn outputs_are_valid(&self, motor: &Motor) -> bool {
        in_range(motor)
    }
}

impl Telemetry for Balance {}

impl Recorded for Balance {
    type Views = ();
}
