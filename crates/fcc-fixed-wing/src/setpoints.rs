//! The autopilot's set points.

use core::f64::consts::{PI, TAU};

use crate::Contingency;
use fcc_core::flight::AltitudeReference;
use fcc_core::schema;
use fcc_guidance::Progress;
use fcc_guidance::route::TookOff;

schema! {
    /// The autopilot's set points: those of guidance, and those of the outer
    /// loops for the inner ones.
    ///
    /// ```
    /// use fcc_fixed_wing::Setpoints;
    /// use fcc_guidance::{Mode, Progress};
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
        /// True course of the path over the ground where it is nearest, rad; 0 in a
        /// mode that follows none.
        #[field(11, range = -PI..=PI)]
        pub course_rad: f64,
        /// How far the aircraft is to the right of the path, m.
        #[field(12)]
        pub cross_track_m: f64,
        /// How far it is to the leg's end, a turn's item or a circle's centre, m.
        #[field(13)]
        pub to_go_m: f64,
        /// The first 64 bits of the SHA-256 of the flight plan; 0 without one.
        #[field(14)]
        pub plan_hash: u64,
        /// When the flight plan was uploaded, s since 1970 (UTC).
        #[field(15)]
        pub plan_uploaded_unix_s: u64,
        /// What the autopilot does by itself, and why.
        #[field(16)]
        pub contingency: Contingency,
        /// Where the aircraft took off; in every state.
        #[field(17, column = "took_off_*")]
        pub took_off: TookOff,
    }
}
