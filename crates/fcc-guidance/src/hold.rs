//! Holds the captured values.

use super::{Guidance, Mode, Progress, Targets};
use fcc_navigation::Estimate;

/// Keeps the heading, altitude and airspeed that were captured or commanded.
///
/// ```
/// use fcc_guidance::{Guidance, Hold, Targets};
/// use fcc_navigation::Estimate;
///
/// let captured = Targets { airspeed_mps: 51.4, heading_rad: 0.0, altitude_m: 914.4 };
/// let mut hold = Hold::enter((), captured);
/// hold.advance(&Estimate::default(), 3_600.0);
/// assert_eq!(hold.targets(), captured);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Hold {
    captured: Targets,
    elapsed_s: f64,
}

impl Guidance for Hold {
    type Config = ();

    const MODE: Mode = Mode::Hold;

    fn resume((): (), progress: &Progress) -> Self {
        Self {
            captured: progress.captured,
            elapsed_s: progress.elapsed_s,
        }
    }

    fn targets(&self) -> Targets {
        self.captured
    }

    fn advance(&mut self, _estimate: &Estimate, dt_s: f64) {
        self.elapsed_s += dt_s;
    }

    fn progress(&self) -> Progress {
        Progress {
            mode: Self::MODE,
            item: 0,
            elapsed_s: self.elapsed_s,
            captured: self.captured,
        }
    }

    fn shift_altitude(&mut self, by_m: f64) {
        self.captured.altitude_m += by_m;
    }
}
