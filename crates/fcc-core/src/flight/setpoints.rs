//! The autopilot's set points.

use core::f64::consts::TAU;

use super::AltitudeReference;
use super::guidance::Progress;
use crate::schema;

schema! {
    /// The autopilot's set points: those of guidance, and those of the outer
    /// loops for the inner ones.
    ///
    /// ```
    /// use fcc_core::flight::Setpoints;
    /// use fcc_core::flight::guidance::{Mode, Progress};
    ///
    /// let setpoints = Setpoints {
    ///     altitude_m: 960.12,
    ///     guidance: Progress { mode: Mode::TimedPattern, item: 1, ..Progress::default() },
    ///     ..Setpoints::default()
    /// };
    /// assert_eq!(setpoints.guidance.to_string(), "timed-pattern leg 1");
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Setpoints {
        /// Indicated airspeed, m/s.
        #[field(1)]
        pub airspeed_mps: f64,
        /// Magnetic heading, rad.
        #[field(2, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// Pressure altitude, m, whatever the set point refers to.
        #[field(3)]
        pub altitude_m: f64,
        /// Bank commanded by the heading loop, rad, right wing down.
        #[field(4)]
        pub roll_rad: f64,
        /// Climb rate commanded by the altitude loop, m/s, up.
        #[field(5)]
        pub climb_rate_mps: f64,
        /// Pitch commanded by the climb-rate loop, rad, nose up.
        #[field(6)]
        pub pitch_rad: f64,
        /// Guidance's mode and its progress; its captured heading is 0..2π.
        #[field(7, column = "guidance_*")]
        pub guidance: Progress,
        /// The altimeter setting (QNH), Pa; in every state.
        #[field(8)]
        pub altimeter_setting_pa: f64,
        /// What the altitude refers to.
        #[field(9)]
        pub altitude_reference: AltitudeReference,
        /// The altitude above what it refers to, m.
        #[field(10)]
        pub altitude_above_reference_m: f64,
    }
}
