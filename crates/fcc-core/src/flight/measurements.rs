//! The measurements of an aircraft's sensors.

use core::f64::consts::{FRAC_PI_2, PI, TAU};
use core::time::Duration;

use libm::cos;

use super::{Battery, GnssFix, MagneticField, OtherControl, Plant, Surfaces};
use crate::framework::{Reading, Switch, Time};
use crate::{readings, schema};

schema! {
    /// The measurements of an aircraft's sensors, each with the time it was
    /// taken.
    ///
    /// Control needs attitude, heading, body rates, specific force, airspeed
    /// and altitude, as in the thesis; position and ground velocity are for
    /// navigation, if there is a source, and are never needed for control.
    ///
    /// From field 16 on they are raw: what the parts of a small computer or a
    /// phone give, in body axes after their calibration,
    /// from which navigation computes the others, if it is configured to.
    ///
    /// ```
    /// use core::time::Duration;
    /// use fcc_core::flight::Measurements;
    /// use fcc_core::framework::{Reading, Time};
    ///
    /// let now = Time::from_nanos(1_000_000_000);
    /// let measured = Measurements {
    ///     airspeed_mps: Reading::new(51.4, now),
    ///     ..Measurements::default()
    /// };
    /// assert!(measured.airspeed_mps.is_fresh(now, Duration::from_millis(250)));
    /// assert!(measured.position.is_never());
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Measurements {
        /// Pitch and roll.
        #[field(1)]
        pub attitude: Reading<Attitude>,
        /// Magnetic heading in rad, clockwise from magnetic north.
        #[field(2, range = 0.0..=TAU)]
        pub heading_rad: Reading<f64>,
        /// Turn rates about the body axes.
        #[field(3)]
        pub body_rates: Reading<BodyRates>,
        /// Specific force, as accelerometers measure it.
        #[field(4, column = "specific_force_*")]
        pub specific_force: Reading<SpecificForce>,
        /// Indicated airspeed in m/s.
        #[field(5)]
        pub airspeed_mps: Reading<f64>,
        /// Pressure altitude in m: barometric, above the pressure level of
        /// 1,013.25 hPa, whatever altimeter settings are.
        #[field(6)]
        pub altitude_m: Reading<f64>,
        /// Angle of attack in rad, positive when the air comes from below the nose.
        #[field(7)]
        pub angle_of_attack_rad: Reading<f64>,
        /// Position of the aircraft; for navigation.
        #[field(8)]
        pub position: Reading<Position>,
        /// Velocity over the ground; for navigation.
        #[field(9)]
        pub velocity: Reading<Velocity>,
        /// Positions of throttle and surfaces, if the plant measures them: for
        /// a bumpless engagement.
        #[field(10, column = "measured_*")]
        pub surfaces: Reading<Surfaces>,
        /// The engage switch.
        #[field(11)]
        pub engage_switch: Reading<Switch>,
        /// A simulated plant's clock and state; never taken on a real one.
        #[field(12, column = "plant_*")]
        pub plant: Reading<Plant>,
        /// What else acts on the controls, if the source can tell.
        #[field(13, column = "other_*")]
        pub other_control: Reading<OtherControl>,
        /// Where the pilot holds the controls, while another one moves the
        /// surfaces.
        #[field(15, column = "pilot_*")]
        pub pilot_controls: Reading<PilotControls>,
        /// Specific force from an accelerometer, its bias included.
        #[field(16, column = "raw_specific_force_*")]
        pub raw_specific_force: Reading<SpecificForce>,
        /// Turn rates from a gyroscope, its bias included.
        #[field(17, column = "raw_*")]
        pub raw_body_rates: Reading<BodyRates>,
        /// Magnetic field from a magnetometer.
        #[field(18, column = "magnetic_field_*")]
        pub magnetic_field: Reading<MagneticField>,
        /// Static pressure in Pa, from a barometer.
        #[field(19)]
        pub static_pressure_pa: Reading<f64>,
        /// Total minus static pressure in Pa, from a pitot tube.
        #[field(20)]
        pub differential_pressure_pa: Reading<f64>,
        /// Temperature of the air outside in K.
        #[field(21)]
        pub air_temperature_k: Reading<f64>,
        /// A fix of satellite navigation.
        #[field(22, column = "gnss_*")]
        pub gnss: Reading<GnssFix>,
        /// Distance in m to the ground or an obstacle, along the body's z axis.
        #[field(23)]
        pub range_m: Reading<f64>,
        /// Whether the wheels bear weight: 0 in the air, 1 on the ground.
        #[field(24, range = 0.0..=1.0)]
        pub weight_on_wheels: Reading<f64>,
        /// Speed of the engine's shaft, rad/s; of the first of several.
        #[field(25)]
        pub engine_speed_radps: Reading<f64>,
        /// The battery that feeds this computer or the aircraft.
        #[field(26, column = "battery_*")]
        pub battery: Reading<Battery>,
    }
}

readings!(Measurements {
    attitude: "attitude",
    heading_rad: "heading",
    body_rates: "body rates",
    specific_force: "acceleration",
    airspeed_mps: "airspeed",
    altitude_m: "altitude",
    angle_of_attack_rad: "angle of attack",
    position: "position",
    velocity: "velocity",
    surfaces: "surfaces",
    engage_switch: "engage switch",
    plant: "the plant's state",
    other_control: "other control",
    pilot_controls: "the pilot's controls",
    raw_specific_force: "raw acceleration",
    raw_body_rates: "raw body rates",
    magnetic_field: "magnetic field",
    static_pressure_pa: "static pressure",
    differential_pressure_pa: "differential pressure",
    air_temperature_k: "air temperature",
    gnss: "satellite navigation",
    range_m: "range",
    weight_on_wheels: "weight on wheels",
    engine_speed_radps: "engine speed",
    battery: "battery",
});

/// A range is used for so long.
const RANGE_AGE: Duration = Duration::from_millis(250);

impl Measurements {
    /// The height above the ground by a range that is current, m, at an attitude in rad: the
    /// range is measured along the body's z axis.
    pub fn height_by_range_m(&self, now: Time, roll_rad: f64, pitch_rad: f64) -> Option<f64> {
        let range_m = self.range_m.fresh(now, RANGE_AGE)?;
        Some(range_m * cos(roll_rad) * cos(pitch_rad))
    }
}

schema! {
    /// Pitch and roll, rad.
    ///
    /// ```
    /// use fcc_core::flight::Attitude;
    ///
    /// let climbing = Attitude { pitch_rad: 10.0_f64.to_radians(), ..Attitude::default() };
    /// assert_eq!(climbing.roll_rad, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Attitude {
        /// Nose above the horizon.
        #[field(1, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub pitch_rad: f64,
        /// Right wing down.
        #[field(2, range = -PI..=PI)]
        pub roll_rad: f64,
    }
}

schema! {
    /// Turn rates about the body axes, rad/s. Nothing that flies turns as fast as the
    /// end of the range, and gyroscopes measure a third of it.
    ///
    /// ```
    /// use fcc_core::flight::BodyRates;
    ///
    /// // A standard rate turn is 3 °/s: two minutes for a full one.
    /// let turn = BodyRates { yaw_radps: 3.0_f64.to_radians(), ..BodyRates::default() };
    /// assert!((core::f64::consts::TAU / turn.yaw_radps - 120.0).abs() < 1e-9);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct BodyRates {
        /// P, about x: right wing down.
        #[field(1, range = -100.0..=100.0, column = "roll_rate_radps")]
        pub roll_radps: f64,
        /// Q, about y: nose up.
        #[field(2, range = -100.0..=100.0, column = "pitch_rate_radps")]
        pub pitch_radps: f64,
        /// R, about z: nose right.
        #[field(3, range = -100.0..=100.0, column = "yaw_rate_radps")]
        pub yaw_radps: f64,
    }
}

schema! {
    /// Acceleration minus gravity, along the body axes, m/s², as an
    /// accelerometer measures it. In level unaccelerated flight z is -9.81. The range
    /// is some 100 g, six times that of usual accelerometers.
    ///
    /// ```
    /// use fcc_core::flight::SpecificForce;
    ///
    /// // A level turn at 60° of bank has a load factor of 2.
    /// let turn = SpecificForce { z_mps2: -2.0 * 9.806_65, ..SpecificForce::default() };
    /// assert!(turn.z_mps2 < -19.6);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct SpecificForce {
        /// Forward.
        #[field(1, range = -1e3..=1e3)]
        pub x_mps2: f64,
        /// Right.
        #[field(2, range = -1e3..=1e3)]
        pub y_mps2: f64,
        /// Down.
        #[field(3, range = -1e3..=1e3)]
        pub z_mps2: f64,
    }
}

schema! {
    /// A position on the WGS 84 ellipsoid.
    ///
    /// ```
    /// use fcc_core::flight::Position;
    ///
    /// // The threshold of runway 25L at Milwaukee (KMKE), 723 ft.
    /// let position = Position {
    ///     latitude_rad: 42.95_f64.to_radians(),
    ///     longitude_rad: -87.88_f64.to_radians(),
    ///     altitude_m: 220.4,
    /// };
    /// assert!(position.longitude_rad < 0.0, "west of Greenwich");
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Position {
        /// North of the equator.
        #[field(1, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub latitude_rad: f64,
        /// East of Greenwich.
        #[field(2, range = -PI..=PI)]
        pub longitude_rad: f64,
        /// Above mean sea level, m.
        #[field(3, column = "position_altitude_m")]
        pub altitude_m: f64,
    }
}

impl Position {
    /// Whether it is a position on the Earth; false for NaN.
    pub fn is_on_earth(&self) -> bool {
        self.latitude_rad.abs() <= FRAC_PI_2 && self.longitude_rad.abs() <= TAU
    }
}

schema! {
    /// Velocity over the ground, m/s.
    ///
    /// ```
    /// use fcc_core::flight::Velocity;
    ///
    /// // Climbing 500 ft/min: down is negative.
    /// let climb = Velocity { down_mps: -2.54, ..Velocity::default() };
    /// assert!((climb.down_mps * -196.85 - 500.0).abs() < 0.1);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Velocity {
        /// Towards true north.
        #[field(1)]
        pub north_mps: f64,
        /// Towards east.
        #[field(2)]
        pub east_mps: f64,
        /// Down.
        #[field(3)]
        pub down_mps: f64,
    }
}

schema! {
    /// Where the pilot holds the controls, as the hardware measures it and not as
    /// the surfaces move.
    ///
    /// ```
    /// use fcc_core::flight::PilotControls;
    ///
    /// let pulls = PilotControls { pitch: 0.4, ..PilotControls::default() };
    /// assert_eq!(pulls.roll, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct PilotControls {
        /// Pulled, for nose up.
        #[field(1, range = -1.0..=1.0)]
        pub pitch: f64,
        /// To the right.
        #[field(2, range = -1.0..=1.0)]
        pub roll: f64,
        /// Right pedal.
        #[field(3, range = -1.0..=1.0)]
        pub yaw: f64,
    }
}

impl PilotControls {
    /// Full deflection, and a little more of an axis that is not calibrated.
    const MOST: f64 = 1.1;

    /// Whether all axes are finite, and none is beyond full deflection.
    pub fn is_valid(&self) -> bool {
        let axes = [self.pitch, self.roll, self.yaw];
        axes.iter().all(|axis| axis.abs() <= Self::MOST)
    }
}
