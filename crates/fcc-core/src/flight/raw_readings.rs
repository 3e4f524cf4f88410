//! The values that only raw sensors give, and those of engine and battery.

use super::{Position, Velocity};
use crate::framework::schema::in_range;
use crate::schema;

schema! {
    /// The magnetic field along the body axes, µT: the earth's, 22 to 67 µT,
    /// and what the aircraft adds to it. The range is four times the 4,912 µT that
    /// magnetometers of phones measure.
    ///
    /// ```
    /// use fcc_core::flight::MagneticField;
    ///
    /// // Level flight to magnetic north in Milwaukee: the field points down by 69°.
    /// let north = MagneticField { x_ut: 19.0, z_ut: 49.5, ..MagneticField::default() };
    /// assert!(north.z_ut > north.x_ut);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct MagneticField {
        /// Forward.
        #[field(1, range = -2e4..=2e4)]
        pub x_ut: f64,
        /// Right.
        #[field(2, range = -2e4..=2e4)]
        pub y_ut: f64,
        /// Down.
        #[field(3, range = -2e4..=2e4)]
        pub z_ut: f64,
    }
}

schema! {
    /// A fix of satellite navigation, with its accuracies as the receiver
    /// estimates them (one standard deviation); 0 if it does not.
    ///
    /// ```
    /// use fcc_core::flight::{GnssFix, Velocity};
    ///
    /// let fix = GnssFix {
    ///     velocity: Velocity { north_mps: 51.4, ..Velocity::default() },
    ///     speed_accuracy_mps: 0.1,
    ///     ..GnssFix::default()
    /// };
    /// assert!(fix.velocity.north_mps > fix.speed_accuracy_mps);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct GnssFix {
        /// Where the antenna is.
        #[field(1)]
        pub position: Position,
        /// Its velocity over the ground.
        #[field(2)]
        pub velocity: Velocity,
        /// Of the position, north and east, m.
        #[field(3, range = 0.0..=1e6)]
        pub horizontal_accuracy_m: f64,
        /// Of the altitude, m.
        #[field(4, range = 0.0..=1e6)]
        pub vertical_accuracy_m: f64,
        /// Of each axis of the velocity, m/s.
        #[field(5, range = 0.0..=1e6)]
        pub speed_accuracy_mps: f64,
    }
}

schema! {
    /// A battery; NaN for what is not measured.
    ///
    /// ```
    /// use fcc_core::flight::Battery;
    ///
    /// // Three cells of lithium polymer, half empty.
    /// let battery = Battery { voltage_v: Some(11.4), charge: Some(0.5) };
    /// assert!(battery.voltage_v.is_some_and(|volts| volts > 3.0 * 3.5));
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Battery {
        /// Its voltage, V.
        #[field(1, range = 0.0..=1_000.0)]
        pub voltage_v: Option<f64>,
        /// What is left of its charge, 0 empty, 1 full.
        #[field(2, range = 0.0..=1.0)]
        pub charge: Option<f64>,
    }
}

impl Battery {
    /// Whether what is measured of it is in its range.
    pub fn is_valid(&self) -> bool {
        in_range(&Self {
            voltage_v: Some(self.voltage_v.unwrap_or(0.0)),
            charge: Some(self.charge.unwrap_or(0.0)),
        })
    }
}
