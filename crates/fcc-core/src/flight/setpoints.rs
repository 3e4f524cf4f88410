//! What the autopilot aims for.

use core::f64::consts::TAU;

use super::guidance::Progress;
use crate::schema;

schema! {
    /// What the autopilot aims for: guidance's set points, and those that the
    /// outer loops hand to the inner ones.
    ///
    /// ```
    /// use fcc_core::flight::Setpoints;
    /// use fcc_core::flight::guidance::{Mode, Progress};
    ///
    /// let aims = Setpoints {
    ///     altitude_m: 960.12,
    ///     guidance: Progress { mode: Mode::TimedPattern, item: 1, ..Progress::default() },
    ///     ..Setpoints::default()
    /// };
    /// assert_eq!(aims.guidance.to_string(), "timed-pattern leg 1");
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Setpoints {
        /// Indicated airspeed, m/s.
        #[field(1)]
        pub airspeed_mps: f64,
        /// Magnetic heading, rad.
        #[field(2, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// Barometric altitude, m.
        #[field(3)]
        pub altitude_m: f64,
        /// Bank that the heading loop asks for, rad, right wing down.
        #[field(4)]
        pub roll_rad: f64,
        /// Climb rate that the altitude loop asks for, m/s, up.
        #[field(5)]
        pub climb_rate_mps: f64,
        /// Pitch that the climb-rate loop asks for, rad, nose up.
        #[field(6)]
        pub pitch_rad: f64,
        /// The mode that guidance flies, and how far it has come; its captured
        /// heading is 0..2π.
        #[field(7, column = "guidance_*")]
        pub guidance: Progress,
    }
}
