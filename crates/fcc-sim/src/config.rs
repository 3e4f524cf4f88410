//! The configuration of a simulation.

use thiserror::Error;

use crate::airframe::Airframe;
use crate::sensing::SensorConfig;
use crate::servos::Servos;
use crate::trim::TrimError;
use crate::turbulence::Severity;
use crate::units::{FOOT_M, KNOT_MPS, POUND_KG};

/// The configuration of a simulation. The default: a light single with two
/// aboard and full tanks at 3,000 ft and 100 kt indicated, heading north,
/// trimmed, in calm air, with perfect sensors, and an engage switch that is
/// switched on after 2 s.
#[derive(Clone, PartialEq, Debug)]
pub struct SimConfig {
    /// The aircraft.
    pub airframe: Airframe,
    /// Its actuators.
    pub servos: Servos,
    /// Height above mean sea level at the start, m, 0..=15000.
    pub altitude_m: f64,
    /// Indicated airspeed at the start, m/s, 10..=150.
    pub indicated_airspeed_mps: f64,
    /// True heading at the start, rad.
    pub heading_rad: f64,
    /// Latitude of the start, rad, at most 80° from the equator: here the flat
    /// earth touches the ellipsoid.
    pub latitude_rad: f64,
    /// See `latitude_rad`; -π..=π.
    pub longitude_rad: f64,
    /// Magnetic variation, rad, positive east.
    pub magnetic_variation_rad: f64,
    /// Steady wind.
    pub wind: Wind,
    /// Gusts, if any.
    pub gusts: Option<Severity>,
    /// Errors and delay of the sensors.
    pub sensors: SensorConfig,
    /// When the engage switch is switched on and off.
    pub switch: SwitchScript,
    /// Longest step of the integration, s, 0.0001..=0.01: each tick is split
    /// into equal steps no longer than this.
    pub substep_s: f64,
    /// Seed of gusts and noise: the same seed gives the same flight.
    pub seed: u64,
}

/// A steady wind, the same everywhere.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Wind {
    /// True direction it comes from, rad.
    pub from_rad: f64,
    /// Speed, m/s, 0..=60.
    pub speed_mps: f64,
}

/// When the engage switch is switched on and off, in s of simulated time;
/// `None` means never.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SwitchScript {
    /// The time at which it is switched on.
    pub on_at_s: Option<f64>,
    /// The time at which it is switched off again.
    pub off_at_s: Option<f64>,
}

impl Default for SimConfig {
    fn default() -> Self {
        Self {
            airframe: Airframe {
                // 1,414 lb empty, 340 lb of people, 40 gal of fuel.
                mass_kg: 2_000.0 * POUND_KG,
                ..Airframe::SKYHAWK
            },
            servos: Servos::default(),
            altitude_m: 3000.0 * FOOT_M,
            indicated_airspeed_mps: 100.0 * KNOT_MPS,
            heading_rad: 0.0,
            latitude_rad: 0.0,
            longitude_rad: 0.0,
            magnetic_variation_rad: 0.0,
            wind: Wind::default(),
            gusts: None,
            sensors: SensorConfig::default(),
            switch: SwitchScript {
                on_at_s: Some(2.0),
                off_at_s: None,
            },
            substep_s: 1.0 / 120.0,
            seed: 1,
        }
    }
}

/// Why a simulation cannot be built.
#[derive(Clone, Copy, PartialEq, Debug, Error)]
#[non_exhaustive]
pub enum SimError {
    /// A number is outside its range.
    #[error("{field} is {value}; it must be {allowed}")]
    Invalid {
        /// The field of [`SimConfig`].
        field: &'static str,
        /// Its value.
        value: f64,
        /// The permitted range.
        allowed: &'static str,
    },
    /// The aircraft cannot be trimmed for level flight there.
    #[error(transparent)]
    Trim(#[from] TrimError),
}

impl SimConfig {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SimError::Invalid`] with the first field that is out of range.
    pub fn validate(&self) -> Result<(), SimError> {
        use core::f64::consts::PI;
        const ANGLE: &str = "-6.284..=6.284 rad";
        let inertia = &self.airframe.inertia;
        let airframe = &self.airframe;
        let travel = &airframe.travel;
        for (field, value) in [
            ("airframe.mass_kg", airframe.mass_kg),
            ("airframe.inertia.xx", inertia.xx),
            ("airframe.inertia.yy", inertia.yy),
            ("airframe.inertia.zz", inertia.zz),
            ("airframe.wing_area_m2", airframe.wing_area_m2),
            ("airframe.wing_span_m", airframe.wing_span_m),
            ("airframe.chord_m", airframe.chord_m),
            (
                "airframe.propulsion.diameter_m",
                airframe.propulsion.diameter_m,
            ),
            ("airframe.travel.elevator_up_rad", travel.elevator_up_rad),
            (
                "airframe.travel.elevator_down_rad",
                travel.elevator_down_rad,
            ),
            ("airframe.travel.aileron_rad", travel.aileron_rad),
            ("airframe.travel.rudder_rad", travel.rudder_rad),
            (
                "servos.surfaces.rate_per_s",
                self.servos.surfaces.rate_per_s,
            ),
            (
                "servos.throttle.rate_per_s",
                self.servos.throttle.rate_per_s,
            ),
        ] {
            within(field, value, f64::MIN_POSITIVE, f64::MAX, "more than 0")?;
        }
        let largest_xz = libm::sqrt(inertia.xx * inertia.zz);
        within(
            "airframe.inertia.xz",
            inertia.xz.abs(),
            0.0,
            0.999 * largest_xz,
            "smaller than √(xx·zz)",
        )?;
        for (field, value) in [
            ("servos.surfaces.lag_s", self.servos.surfaces.lag_s),
            ("servos.throttle.lag_s", self.servos.throttle.lag_s),
        ] {
            within(field, value, 0.0, 10.0, "0..=10 s")?;
        }
        within("altitude_m", self.altitude_m, 0.0, 15_000.0, "0..=15000 m")?;
        within(
            "indicated_airspeed_mps",
            self.indicated_airspeed_mps,
            10.0,
            150.0,
            "10..=150 m/s",
        )?;
        within("heading_rad", self.heading_rad, -2.0 * PI, 2.0 * PI, ANGLE)?;
        within(
            "latitude_rad",
            self.latitude_rad,
            -1.4,
            1.4,
            "-1.4..=1.4 rad",
        )?;
        within("longitude_rad", self.longitude_rad, -PI, PI, "-π..=π rad")?;
        within(
            "magnetic_variation_rad",
            self.magnetic_variation_rad,
            -PI,
            PI,
            "-π..=π rad",
        )?;
        within(
            "wind.from_rad",
            self.wind.from_rad,
            -2.0 * PI,
            2.0 * PI,
            ANGLE,
        )?;
        within(
            "wind.speed_mps",
            self.wind.speed_mps,
            0.0,
            60.0,
            "0..=60 m/s",
        )?;
        within("substep_s", self.substep_s, 1e-4, 0.01, "0.0001..=0.01 s")?;
        for (field, time) in [
            ("switch.on_at_s", self.switch.on_at_s),
            ("switch.off_at_s", self.switch.off_at_s),
        ] {
            if let Some(time_s) = time {
                within(field, time_s, 0.0, f64::MAX, "a time of 0 s or later")?;
            }
        }
        self.sensors.validate()
    }
}

/// `value` if it lies in `low..=high`; a NaN never does.
pub(crate) fn within(
    field: &'static str,
    value: f64,
    low: f64,
    high: f64,
    allowed: &'static str,
) -> Result<(), SimError> {
    if (low..=high).contains(&value) {
        Ok(())
    } else {
        Err(SimError::Invalid {
            field,
            value,
            allowed,
        })
    }
}
