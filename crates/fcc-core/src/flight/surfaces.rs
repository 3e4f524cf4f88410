//! The autopilot's outputs.

use crate::framework::schema::in_range;
use crate::schema;

schema! {
    /// The autopilot's outputs: throttle and control surfaces.
    ///
    /// ```
    /// use fcc_core::flight::Surfaces;
    ///
    /// let climb = Surfaces { throttle: 1.0, elevator: 0.2, ..Surfaces::default() };
    /// assert!(climb.is_valid());
    /// assert!(!Surfaces { throttle: f64::NAN, ..climb }.is_valid());
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Surfaces {
        /// 0 idle, 1 full.
        #[field(1, range = 0.0..=1.0)]
        pub throttle: f64,
        /// Positive raises the nose.
        #[field(2, range = -1.0..=1.0)]
        pub elevator: f64,
        /// Positive rolls right.
        #[field(3, range = -1.0..=1.0)]
        pub aileron: f64,
        /// Positive yaws right.
        #[field(4, range = -1.0..=1.0)]
        pub rudder: f64,
        /// The elevator's trim, positive raises the nose; NaN where the aircraft
        /// has none or it is not measured, and then it is left as it is.
        #[field(5, range = -1.0..=1.0)]
        pub elevator_trim: Option<f64>,
    }
}

impl Surfaces {
    /// Whether every value is finite and in its range; a trim may be missing.
    pub fn is_valid(&self) -> bool {
        in_range(&Self {
            elevator_trim: Some(self.elevator_trim.unwrap_or(0.0)),
            ..*self
        })
    }
}
