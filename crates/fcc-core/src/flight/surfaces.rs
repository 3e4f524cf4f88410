//! The autopilot's outputs.

use crate::framework::schema::in_range;
use crate::schema;

schema! {
    /// The autopilot's outputs: throttle, control surfaces, and what a runway needs.
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
        /// Flaps, 0 up, 1 fully extended; NaN leaves them as they are.
        #[field(6, range = 0.0..=1.0)]
        pub flaps: Option<f64>,
        /// The left wheel's brake, 0 released, 1 full; NaN leaves it as it is.
        #[field(7, range = 0.0..=1.0)]
        pub left_brake: Option<f64>,
        /// The right wheel's brake, likewise.
        #[field(8, range = 0.0..=1.0)]
        pub right_brake: Option<f64>,
        /// The nose wheel's steering, positive to the right; NaN where it is not
        /// steered by itself.
        #[field(9, range = -1.0..=1.0)]
        pub nose_wheel: Option<f64>,
        /// The landing gear, 0 up, 1 down; NaN leaves it as it is.
        #[field(10, range = 0.0..=1.0)]
        pub gear: Option<f64>,
    }
}

impl Surfaces {
    /// Idle throttle and centred surfaces; all else is left as it is.
    pub const IDLE: Self = Self {
        throttle: 0.0,
        elevator: 0.0,
        aileron: 0.0,
        rudder: 0.0,
        elevator_trim: None,
        flaps: None,
        left_brake: None,
        right_brake: None,
        nose_wheel: None,
        gear: None,
    };

    /// Whether every value is finite and in its range; those that an aircraft need not
    /// have may be missing.
    pub fn is_valid(&self) -> bool {
        let given = |value: Option<f64>| Some(value.unwrap_or(0.0));
        in_range(&Self {
            elevator_trim: given(self.elevator_trim),
            flaps: given(self.flaps),
            left_brake: given(self.left_brake),
            right_brake: given(self.right_brake),
            nose_wheel: given(self.nose_wheel),
            gear: given(self.gear),
            ..*self
        })
    }
}
