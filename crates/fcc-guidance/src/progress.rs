//! The progress of a mode.

use core::fmt;

use super::{Mode, Targets};
use fcc_core::schema;

schema! {
    /// The progress of a mode: for observers, and all that is needed to
    /// continue the mode elsewhere.
    ///
    /// ```
    /// use fcc_guidance::{Mode, Progress};
    ///
    /// let progress = Progress { mode: Mode::Hold, elapsed_s: 12.5, ..Progress::default() };
    /// assert!(progress.is_valid());
    /// assert!(!Progress::default().is_valid(), "nothing is flown");
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Progress {
        /// The mode.
        #[field(1)]
        pub mode: Mode,
        /// The present part of the mode: of a pattern, the leg; of a plan, the item, from 1.
        #[field(2)]
        pub item: u32,
        /// How long it has been active, s of the plant's time.
        #[field(3)]
        pub elapsed_s: f64,
        /// The values captured when it was entered.
        #[field(4, column = "captured_*")]
        pub captured: Targets,
    }
}

impl Progress {
    /// Whether this is a valid progress: a mode, and finite numbers.
    pub fn is_valid(&self) -> bool {
        self.mode != Mode::None
            && self.captured.is_finite()
            && self.elapsed_s.is_finite()
            && self.elapsed_s >= 0.0
    }
}

impl fmt::Display for Progress {
    /// The mode and its present part: `timed-pattern leg 3`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.mode {
            // A landing that was commanded where it took off has none.
            Mode::Plan | Mode::Takeoff | Mode::Land | Mode::GoAround if self.item > 0 => {
                write!(f, "{} item {}", self.mode, self.item)
            }
            Mode::TimedPattern => write!(f, "{} leg {}", self.mode, self.item),
            _ => write!(f, "{}", self.mode),
        }
    }
}
