//! The outputs of a multicopter.

use crate::schema;

/// The most rotors of a multicopter.
pub const MOST_ROTORS: usize = 8;

schema! {
    /// The speeds of a multicopter's motors, 0 off, 1 full; none where there is no motor.
    ///
    /// ```
    /// use fcc_core::flight::Motors;
    ///
    /// let hover = Motors::from([Some(0.5), Some(0.5), Some(0.5), Some(0.5), None, None, None, None]);
    /// assert_eq!((hover.motor_4, hover.motor_5), (Some(0.5), None));
    /// assert_eq!(Motors::from(hover.speeds()), hover);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Motors {
        /// In front on the right, or the first one to the right of the nose.
        #[field(1, range = 0.0..=1.0)]
        pub motor_1: Option<f64>,
        /// The next one clockwise, seen from above.
        #[field(2, range = 0.0..=1.0)]
        pub motor_2: Option<f64>,
        /// The next one.
        #[field(3, range = 0.0..=1.0)]
        pub motor_3: Option<f64>,
        /// The next one.
        #[field(4, range = 0.0..=1.0)]
        pub motor_4: Option<f64>,
        /// The next one.
        #[field(5, range = 0.0..=1.0)]
        pub motor_5: Option<f64>,
        /// The next one.
        #[field(6, range = 0.0..=1.0)]
        pub motor_6: Option<f64>,
        /// The next one.
        #[field(7, range = 0.0..=1.0)]
        pub motor_7: Option<f64>,
        /// The next one.
        #[field(8, range = 0.0..=1.0)]
        pub motor_8: Option<f64>,
    }
}

impl From<[Option<f64>; MOST_ROTORS]> for Motors {
    fn from(speeds: [Option<f64>; MOST_ROTORS]) -> Self {
        let [
            motor_1,
            motor_2,
            motor_3,
            motor_4,
            motor_5,
            motor_6,
            motor_7,
            motor_8,
        ] = speeds;
        Self {
            motor_1,
            motor_2,
            motor_3,
            motor_4,
            motor_5,
            motor_6,
            motor_7,
            motor_8,
        }
    }
}

impl Motors {
    /// Whether every motor's speed is in its range.
    pub fn are_valid(&self) -> bool {
        let mut speeds = self.speeds().into_iter().flatten();
        speeds.all(|speed| (0.0..=1.0).contains(&speed))
    }

    /// The speeds in the order of the rotors.
    pub const fn speeds(&self) -> [Option<f64>; MOST_ROTORS] {
        [
            self.motor_1,
            self.motor_2,
            self.motor_3,
            self.motor_4,
            self.motor_5,
            self.motor_6,
            self.motor_7,
            self.motor_8,
        ]
    }
}
