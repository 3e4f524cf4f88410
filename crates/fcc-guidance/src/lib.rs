//! Guidance: the targets of control.
//!
//! A [mode](Mode) is a kind of guidance: hold the captured values, fly a
//! pattern, follow a route over the ground. Each is a [`Guidance`] or an
//! [`OverGroundMode`]; [`ActiveMode`] contains the active one, and
//! [`Mode::after`] is the transition table of the modes. A mode's state is its
//! [`Progress`], which is part of the record of every tick, so that it need not
//! be derived from events.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod active;
#[cfg(test)]
#[path = "tests/conformance.rs"]
mod conformance;
pub mod fence;
mod hold;
mod mode;
mod over_ground_mode;
pub mod path;
mod pattern;
mod progress;
pub mod route;

use core::f64::consts::TAU;

use fcc_navigation::Estimate;

pub use active::{ActiveMode, GuidanceConfig};
pub use hold::Hold;
pub use mode::{Mode, ModeInput};
pub use over_ground_mode::OverGroundMode;
pub use pattern::{TimedPattern, TimedPatternConfig};
pub use progress::Progress;

use fcc_core::schema;

schema! {
    /// The targets that guidance sets for control.
    ///
    /// ```
    /// use fcc_guidance::Targets;
    ///
    /// // A turn to the right from 350° to 80°: 440°, not 80°.
    /// let target = Targets { heading_rad: 440.0_f64.to_radians(), ..Targets::default() };
    /// assert!(target.is_finite() && target.heading_rad > 350.0_f64.to_radians());
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Targets {
        /// Indicated airspeed, m/s.
        #[field(1)]
        pub airspeed_mps: f64,
        // Continuous through full turns inside of the loop: the number determines the
        // direction of the turn. Turns that accumulate faster than the aircraft can
        // follow are never reversed.
        /// Magnetic heading, rad, clockwise from magnetic north.
        #[field(2, range = 0.0..=TAU)]
        pub heading_rad: f64,
        /// Pressure altitude, m.
        #[field(3)]
        pub altitude_m: f64,
    }
}

impl Targets {
    /// Whether all are finite.
    pub const fn is_finite(&self) -> bool {
        self.airspeed_mps.is_finite() && self.heading_rad.is_finite() && self.altitude_m.is_finite()
    }
}

/// A mode of guidance: targets for control, tick by tick.
///
/// The rules of a tick apply: a pure function of its state and arguments,
/// without heap, clock or panic. Every mode is tested by the conformance suite
/// in this module.
///
/// ```
/// use fcc_guidance::{Guidance, Targets, TimedPattern, TimedPatternConfig};
/// use fcc_navigation::Estimate;
///
/// let captured = Targets { airspeed_mps: 51.4, heading_rad: 0.0, altitude_m: 914.4 };
/// let mut pattern = TimedPattern::enter(TimedPatternConfig::default(), captured);
/// assert_eq!(pattern.targets(), captured);
/// // The thesis holds for 20 s, then turns right by 90° and climbs 150 ft.
/// pattern.advance(&Estimate::default(), 20.0);
/// assert!((pattern.targets().heading_rad.to_degrees() - 90.0).abs() < 1e-9);
/// assert!((pattern.targets().altitude_m / 0.304_8 - 3_150.0).abs() < 1e-9);
/// // The progress is all that is needed to continue elsewhere.
/// let again = TimedPattern::resume(TimedPatternConfig::default(), &pattern.progress());
/// assert_eq!(again, pattern);
/// ```
pub trait Guidance: Copy {
    /// The mode's configuration.
    type Config: Copy;

    /// The identifier of this mode.
    const MODE: Mode;

    /// Continues a mode from a progress; `progress.mode` is ignored. From here
    /// on it behaves, to the last bit, like the mode from which the progress
    /// was taken.
    fn resume(config: Self::Config, progress: &Progress) -> Self;

    /// Begins now, with the present targets: at engagement those measured, at a
    /// change of mode those of the previous mode.
    fn enter(config: Self::Config, captured: Targets) -> Self {
        let progress = Progress {
            captured,
            ..Progress::default()
        };
        Self::resume(config, &progress)
    }

    /// The present targets.
    fn targets(&self) -> Targets;

    /// `dt_s` seconds of the plant's time pass, with the aircraft as
    /// estimated; 0 while the plant is paused, which changes nothing.
    fn advance(&mut self, estimate: &Estimate, dt_s: f64);

    /// Its progress.
    fn progress(&self) -> Progress;

    /// Shifts the captured altitude, m, when a refined estimate is available, or
    /// when the altimeter setting by which it was commanded changes.
    fn shift_altitude(&mut self, by_m: f64);
}
