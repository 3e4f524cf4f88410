//! What navigation knows of the aircraft's motion.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use libm::{cos, sin};

use fcc_core::flight::BodyRates;
use fcc_core::schema;
use fcc_core::units::GRAVITY_MPS2;

schema! {
    /// Where the estimate's airspeed comes from.
    ///
    /// ```
    /// use fcc_navigation::AirspeedSource;
    ///
    /// assert_eq!(AirspeedSource::from_number(1), Some(AirspeedSource::Forces));
    /// ```
    pub enum AirspeedSource {
        /// The airspeed sensor.
        Sensor = 0,
        /// Forces and motion: the sensor is doubted or silent.
        Forces = 1,
    }
}

schema! {
    /// Navigation's estimate.
    ///
    /// ```
    /// use fcc_navigation::Estimate;
    ///
    /// let level = Estimate { heading_rad: 10.0_f64.to_radians(), ..Estimate::default() };
    /// assert_eq!(level.roll_rad, 0.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Estimate {
        /// Right wing down, rad.
        #[field(1)]
        pub roll_rad: f64,
        /// Nose up, rad.
        #[field(2)]
        pub pitch_rad: f64,
        // Continuous through full turns inside of the loop, where differences are taken.
        /// Magnetic heading, rad, clockwise from magnetic north.
        #[field(3, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// Turn rates about the body axes.
        #[field(4)]
        pub body_rates: BodyRates,
        /// Indicated airspeed, m/s.
        #[field(5)]
        pub airspeed_mps: f64,
        /// True airspeed, m/s.
        #[field(6)]
        pub true_airspeed_mps: f64,
        /// Pressure altitude, m.
        #[field(7)]
        pub altitude_m: f64,
        /// Climb rate, m/s, up.
        #[field(8)]
        pub climb_rate_mps: f64,
        /// Specific force to the right, m/s²: 0 in a coordinated turn.
        #[field(9)]
        pub side_force_mps2: f64,
        /// Load factor, g, along the body's z axis, upwards.
        #[field(10)]
        pub load_factor: f64,
        /// Standard deviation of the load that gusts cause, g.
        #[field(11)]
        pub gust_load: f64,
        /// Angle of attack, rad: measured if a source has it that is not
        /// doubted, otherwise estimated from the lift.
        #[field(12)]
        pub angle_of_attack_rad: f64,
        /// Acceleration along the flight path, without gusts, m/s².
        #[field(13)]
        pub acceleration_mps2: f64,
        /// The time from an output to its effect, s, measured by the elevator;
        /// until then the assumed one.
        #[field(14)]
        pub output_latency_s: f64,
        /// The play of the elevator, in the elevator's units of -1 to 1.
        #[field(15)]
        pub elevator_play: f64,
        /// Where the airspeed comes from.
        #[field(16)]
        pub airspeed_source: AirspeedSource,
        /// Standard deviation of an airspeed that comes from the forces, m/s;
        /// 0 while the sensor is used.
        #[field(17)]
        pub airspeed_uncertainty_mps: f64,
        /// Latitude by which the modes over the ground fly, rad; 0 before it is known.
        #[field(18, range = -FRAC_PI_2..=FRAC_PI_2)]
        pub latitude_rad: f64,
        /// Longitude, likewise, rad.
        #[field(19, range = -PI..=PI)]
        pub longitude_rad: f64,
        /// Velocity over the ground towards true north, likewise, m/s.
        #[field(20)]
        pub north_mps: f64,
        /// Towards east, m/s.
        #[field(21)]
        pub east_mps: f64,
        /// Wind, towards true north, m/s.
        #[field(22)]
        pub wind_north_mps: f64,
        /// Towards east, m/s.
        #[field(23)]
        pub wind_east_mps: f64,
        /// Standard deviation of the horizontal position, m; it grows while the position is
        /// one of dead reckoning. 0 before a position is known.
        #[field(24)]
        pub position_uncertainty_m: f64,
        /// How old the newest reading was when it arrived, s, by its source's own
        /// clock and relative to the fastest one; 0 if it has none.
        #[field(410)]
        pub reading_age_s: f64,
        /// The mean change of that age from one arrival to the next, s.
        #[field(411)]
        pub reading_jitter_s: f64,
    }
}

impl Estimate {
    /// Before anything was measured.
    pub(super) const INITIAL: Self = Self {
        roll_rad: 0.0,
        pitch_rad: 0.0,
        heading_rad: 0.0,
        body_rates: BodyRates {
            roll_radps: 0.0,
            pitch_radps: 0.0,
            yaw_radps: 0.0,
        },
        airspeed_mps: 0.0,
        true_airspeed_mps: 0.0,
        altitude_m: 0.0,
        climb_rate_mps: 0.0,
        side_force_mps2: 0.0,
        output_latency_s: 0.0,
        elevator_play: 0.0,
        load_factor: 1.0,
        gust_load: 0.0,
        angle_of_attack_rad: 0.0,
        acceleration_mps2: 0.0,
        airspeed_source: AirspeedSource::Sensor,
        airspeed_uncertainty_mps: 0.0,
        latitude_rad: 0.0,
        longitude_rad: 0.0,
        north_mps: 0.0,
        east_mps: 0.0,
        wind_north_mps: 0.0,
        wind_east_mps: 0.0,
        position_uncertainty_m: 0.0,
        reading_age_s: 0.0,
        reading_jitter_s: 0.0,
    };
    /// The yaw rate in excess of that of a level coordinated turn, g/V sin φ cos θ, rad/s.
    pub fn yaw_excess_radps(&self) -> f64 {
        let turn_radps = GRAVITY_MPS2 / self.true_airspeed_mps.max(1.0)
            * sin(self.roll_rad)
            * cos(self.pitch_rad);
        self.body_rates.yaw_radps - turn_radps
    }
}
