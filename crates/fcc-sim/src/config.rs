//! The configuration of a simulation.

use fcc_core::flight::terrain::Terrain;
use fcc_core::framework::Switch;
use thiserror::Error;

use crate::airframe::Airframe;
use crate::electrical::Electrical;
use crate::raw::RawSensorSet;
use crate::servos::Servos;
use crate::trim::TrimError;
use crate::turbulence::Severity;
use crate::units::{DEGREE_RAD, FOOT_M, KNOT_MPS, POUND_KG};

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
    /// Height above mean sea level at the start, m, 0..=15000, no lower
    /// than the ground.
    pub altitude_m: f64,
    /// The level ground, m above mean sea level, -500..=9000.
    pub ground_m: f64,
    /// The ground where it is known; the level ground is elsewhere.
    pub terrain: Terrain<'static>,
    /// Whether it stands on the ground at the start, with idle throttle and its brakes
    /// set, instead of flying.
    pub on_runway: bool,
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
    /// Inclination of the earth's magnetic field, rad, positive down.
    pub magnetic_inclination_rad: f64,
    /// Strength of the earth's magnetic field, µT, 20..=70.
    pub magnetic_strength_ut: f64,
    /// Steady wind.
    pub wind: Wind,
    /// Gusts, if any.
    pub gusts: Option<Severity>,
    /// Errors and delay of the sensors.
    pub sensors: SensorConfig,
    /// The raw sensors, if there are any.
    pub raw_sensors: Option<RawSensorSet>,
    /// When the engage switch is switched on and off.
    pub switch: SwitchScript,
    /// When the engine stops for good, s of simulated time; none: never.
    pub engine_stops_at_s: Option<f64>,
    /// Battery and alternator.
    pub electrical: Electrical,
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

impl SwitchScript {
    /// Its position at a time, s.
    pub(crate) fn position(&self, time_s: f64) -> Switch {
        let reached = |at_s: Option<f64>| at_s.is_some_and(|at_s| time_s >= at_s);
        if reached(self.on_at_s) && !reached(self.off_at_s) {
            Switch::On
        } else {
            Switch::Off
        }
    }
}

/// The longest delay of the sensors, ms.
pub const LONGEST_DELAY_MS: u16 = 1000;

/// Errors and delay of the sensors; the default has none.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct SensorConfig {
    /// One standard deviation of the noise on each sample.
    pub noise: Channels,
    /// Added to every sample.
    pub bias: Channels,
    /// Resolution; 0 for full precision.
    pub resolution: Channels,
    /// Delay of the measurements, ms, 0..=1000.
    pub delay_ms: u16,
}

/// One number for each kind of measurement, the same for all its axes.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Channels {
    /// Pitch and roll, rad.
    pub attitude_rad: f64,
    /// Heading, rad.
    pub heading_rad: f64,
    /// Turn rates, rad/s.
    pub rates_radps: f64,
    /// Specific force, m/s².
    pub specific_force_mps2: f64,
    /// Indicated airspeed, m/s.
    pub airspeed_mps: f64,
    /// Barometric altitude, m.
    pub altitude_m: f64,
    /// Angle of attack, rad.
    pub angle_of_attack_rad: f64,
    /// Position north, east and up, m.
    pub position_m: f64,
    /// Velocity over the ground, m/s.
    pub velocity_mps: f64,
}

impl Channels {
    /// Noise typical of a phone's or low-cost sensors: 0.2° of attitude, 0.4°
    /// of heading, 0.3°/s, 0.6 ft/s², 0.7 kt, 2.5 ft, 0.3° of angle of attack,
    /// with 2 m and 0.1 m/s of satellite navigation.
    pub const TYPICAL_NOISE: Self = Self {
        attitude_rad: 0.2 * DEGREE_RAD,
        heading_rad: 0.4 * DEGREE_RAD,
        rates_radps: 0.3 * DEGREE_RAD,
        specific_force_mps2: 0.6 * FOOT_M,
        airspeed_mps: 0.7 * KNOT_MPS,
        altitude_m: 2.5 * FOOT_M,
        angle_of_attack_rad: 0.3 * DEGREE_RAD,
        position_m: 2.0,
        velocity_mps: 0.1,
    };
}

impl SimConfig {
    /// The earth's magnetic field: north, east, down, µT.
    pub fn magnetic_field_ut(&self) -> [f64; 3] {
        let (sin_down, cos_down) = libm::sincos(self.magnetic_inclination_rad);
        let (sin_east, cos_east) = libm::sincos(self.magnetic_variation_rad);
        [cos_down * cos_east, cos_down * sin_east, sin_down]
            .map(|share| self.magnetic_strength_ut * share)
    }
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
            ground_m: 0.0,
            terrain: Terrain::default(),
            on_runway: false,
            indicated_airspeed_mps: 100.0 * KNOT_MPS,
            heading_rad: 0.0,
            latitude_rad: 0.0,
            longitude_rad: 0.0,
            magnetic_variation_rad: 0.0,
            // Of middle latitudes.
            magnetic_inclination_rad: 65.0 * DEGREE_RAD,
            magnetic_strength_ut: 50.0,
            wind: Wind::default(),
            gusts: None,
            sensors: SensorConfig::default(),
            raw_sensors: None,
            switch: SwitchScript {
                on_at_s: Some(2.0),
                off_at_s: None,
            },
            engine_stops_at_s: None,
            electrical: Electrical::default(),
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

/// Checks numbers against their ranges: fields, smallest and largest value, and
/// the range in words. A NaN is in no range.
macro_rules! check {
    ($($($field:expr),+ => $low:expr, $high:expr, $allowed:expr;)+) => {
        $($(
            if !($low..=$high).contains(&$field) {
                return Err(SimError::Invalid {
                    field: stringify!($field).trim_start_matches("self."),
                    value: $field,
                    allowed: $allowed,
                });
            }
        )+)+
    };
}

/// The same for every channel of a set.
macro_rules! check_channels {
    ($set:expr => $low:expr, $high:expr, $allowed:expr) => {
        check! {
            $set.attitude_rad, $set.heading_rad, $set.rates_radps, $set.specific_force_mps2,
            $set.airspeed_mps, $set.altitude_m, $set.angle_of_attack_rad, $set.position_m,
            $set.velocity_mps => $low, $high, $allowed;
        }
    };
}

impl SimConfig {
    /// Checks every number.
    ///
    /// # Errors
    /// [`SimError::Invalid`] with the first field that is out of range.
    pub fn validate(&self) -> Result<(), SimError> {
        use core::f64::consts::{PI, TAU};
        let inertia = &self.airframe.inertia;
        let largest_xz = 0.999 * libm::sqrt(inertia.xx * inertia.zz);
        check! {
            self.airframe.mass_kg, self.airframe.inertia.xx, self.airframe.inertia.yy,
            self.airframe.inertia.zz, self.airframe.wing_area_m2, self.airframe.wing_span_m,
            self.airframe.chord_m, self.airframe.propulsion.diameter_m,
            self.airframe.travel.elevator_up_rad, self.airframe.travel.elevator_down_rad,
            self.airframe.travel.aileron_rad, self.airframe.travel.rudder_rad,
            self.servos.surfaces.rate_per_s, self.servos.throttle.rate_per_s,
            self.airframe.propulsion.power_at_rest, self.electrical.capacity_ah
                => f64::MIN_POSITIVE, f64::MAX, "more than 0";
            self.airframe.inertia.xz => -largest_xz, largest_xz, "smaller than √(xx·zz)";
            self.servos.surfaces.lag_s, self.servos.throttle.lag_s => 0.0, 10.0, "0..=10 s";
            self.altitude_m => 0.0, 15_000.0, "0..=15000 m";
            self.ground_m => -500.0, 9_000.0, "-500..=9000 m";
            self.altitude_m => self.ground_m, f64::MAX, "no lower than ground_m";
            self.indicated_airspeed_mps => 10.0, 150.0, "10..=150 m/s";
            self.heading_rad, self.wind.from_rad => -TAU, TAU, "-6.284..=6.284 rad";
            self.latitude_rad => -1.4, 1.4, "-1.4..=1.4 rad";
            self.longitude_rad, self.magnetic_variation_rad => -PI, PI, "-π..=π rad";
            self.magnetic_inclination_rad => -PI / 2.0, PI / 2.0, "-π/2..=π/2 rad";
            self.magnetic_strength_ut => 20.0, 70.0, "20..=70 µT";
            self.wind.speed_mps => 0.0, 60.0, "0..=60 m/s";
            self.electrical.charge => 0.0, 1.0, "0..=1";
            self.electrical.load_a => 0.0, 60.0, "0..=60 A";
            self.substep_s => 1e-4, 0.01, "0.0001..=0.01 s";
        }
        for (field, time_s) in [
            ("switch.on_at_s", self.switch.on_at_s),
            ("switch.off_at_s", self.switch.off_at_s),
            ("engine_stops_at_s", self.engine_stops_at_s),
            (
                "electrical.alternator_stops_at_s",
                self.electrical.alternator_stops_at_s,
            ),
        ] {
            if let Some(value) = time_s.filter(|time_s| !(0.0..=f64::MAX).contains(time_s)) {
                let allowed = "a time of 0 s or later";
                return Err(SimError::Invalid {
                    field,
                    value,
                    allowed,
                });
            }
        }
        check_channels!(self.sensors.noise => 0.0, f64::MAX, "0 or more");
        check_channels!(self.sensors.bias => -f64::MAX, f64::MAX, "a finite number");
        check_channels!(self.sensors.resolution => 0.0, f64::MAX, "0 or more");
        if self.sensors.delay_ms > LONGEST_DELAY_MS {
            return Err(SimError::Invalid {
                field: "sensors.delay_ms",
                value: self.sensors.delay_ms.into(),
                allowed: "0..=1000 ms",
            });
        }
        Ok(())
    }
}
