//! How far a mode has come.

use core::fmt;

use super::{Mode, Targets};
use crate::schema;

schema! {
    /// How far a mode has come: what an observer needs to know of it, and all that
    /// is needed to go on with it elsewhere.
    ///
    /// ```
    /// use fcc_core::flight::guidance::{Mode, Progress};
    ///
    /// let progress = Progress { mode: Mode::Hold, elapsed_s: 12.5, ..Progress::default() };
    /// assert!(progress.is_valid());
    /// assert!(!Progress::default().is_valid(), "nothing is flown");
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Progress {
        /// Which mode.
        #[field(1)]
        pub mode: Mode,
        /// Which part of it is flown: of a pattern, the leg.
        #[field(2)]
        pub item: u32,
        /// For how long it has been flown, s of the plant's time.
        #[field(3)]
        pub elapsed_s: f64,
        /// What it captured when it was entered.
        #[field(4, column = "captured_*")]
        pub captured: Targets,
    }
}

impl Progress {
    /// Whether a flight can have come this far: a mode, and finite numbers.
    pub fn is_valid(&self) -> bool {
        self.mode != Mode::None
            && self.captured.is_finite()
            && self.elapsed_s.is_finite()
            && self.elapsed_s >= 0.0
    }
}

impl fmt::Display for Progress {
    /// The mode, and where it is: `timed-pattern leg 3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.mode {
            Mode::None | Mode::Hold => write!(f, "{}", self.mode),
            Mode::TimedPattern => write!(f, "{} leg {}", self.mode, self.item),
        }
    }
}
