//! Guidance: where to go next.
//!
//! A [mode](Mode) is one way to go on: keep what was captured, fly a pattern.
//! Each is a [`Guidance`]; [`ActiveMode`] holds the one that is flown, and
//! [`Mode::after`] is the one table of how modes change. What a mode has done
//! so far is its [`Progress`], which stands in the record of every tick, so
//! that nobody has to work it out from events.

mod active;
#[cfg(test)]
mod conformance;
mod hold;
mod mode;
mod pattern;
mod progress;

use super::navigation::Estimate;

pub use active::{ActiveMode, GuidanceConfig};
pub use hold::Hold;
pub use mode::{Mode, ModeInput};
pub use pattern::{TimedPattern, TimedPatternConfig};
pub use progress::Progress;

use crate::schema;

schema! {
    /// What guidance asks of control.
    ///
    /// ```
    /// use fcc_core::flight::guidance::Targets;
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
        /// Magnetic heading, rad, counted on through full turns: which way to turn
        /// is said by the number, not guessed from the shorter way. Turns that
        /// pile up while the aircraft cannot keep up never reverse.
        #[field(2)]
        pub heading_rad: f64,
        /// Barometric altitude, m.
        #[field(3)]
        pub altitude_m: f64,
    }
}

impl Targets {
    /// Whether every one is a finite number.
    pub const fn is_finite(&self) -> bool {
        self.airspeed_mps.is_finite() && self.heading_rad.is_finite() && self.altitude_m.is_finite()
    }
}

/// A mode of guidance: targets for control, tick by tick.
///
/// Under the rules of a tick: a pure function of what it holds and is handed,
/// without heap, clock or panic. Every mode runs the conformance suite beside
/// this trait, which shows what is said here.
///
/// ```
/// use fcc_core::flight::guidance::{Guidance, Targets, TimedPattern, TimedPatternConfig};
/// use fcc_core::flight::navigation::Estimate;
///
/// let captured = Targets { airspeed_mps: 51.4, heading_rad: 0.0, altitude_m: 914.4 };
/// let mut pattern = TimedPattern::enter(TimedPatternConfig::default(), captured);
/// assert_eq!(pattern.targets(), captured);
/// // The thesis holds for 20 s, then turns right by 90° and climbs 150 ft.
/// pattern.advance(&Estimate::default(), 20.0);
/// assert!((pattern.targets().heading_rad.to_degrees() - 90.0).abs() < 1e-9);
/// assert!((pattern.targets().altitude_m / 0.304_8 - 3_150.0).abs() < 1e-9);
/// // What it has done is all that is needed to go on with it elsewhere.
/// let again = TimedPattern::resume(TimedPatternConfig::default(), &pattern.progress());
/// assert_eq!(again, pattern);
/// ```
pub trait Guidance: Copy {
    /// What of this mode is the user's choice.
    type Config: Copy;

    /// Which mode this is.
    const MODE: Mode;

    /// Goes on with a mode that was flown this far; `progress.mode` is not
    /// looked at. From here on it gives, to the last bit, what the one that
    /// the progress is of gives.
    fn resume(config: Self::Config, progress: &Progress) -> Self;

    /// Begins now, with what the aircraft flies: what is measured at
    /// engagement, what was aimed for at a change of mode.
    fn enter(config: Self::Config, captured: Targets) -> Self {
        let progress = Progress {
            captured,
            ..Progress::default()
        };
        Self::resume(config, &progress)
    }

    /// The targets now; no time passes.
    fn targets(&self) -> Targets;

    /// `dt_s` seconds of the plant's time pass, with the aircraft as
    /// estimated; 0 while the plant is paused, which changes nothing.
    fn advance(&mut self, estimate: &Estimate, dt_s: f64);

    /// How far it has come.
    fn progress(&self) -> Progress;

    /// The altitude that was captured turned out to be this much higher, m.
    fn shift_altitude(&mut self, by_m: f64);
}
