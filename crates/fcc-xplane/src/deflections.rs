//! The values that are written for surfaces, throttles and trim.
//!
//! The signs are those used throughout: X-Plane's `yoke_pitch_ratio` is
//! positive nose up, `yoke_roll_ratio` positive right, `yoke_heading_ratio`
//! positive nose right, each -1..1, and so are the columns of row 8; throttles
//! are 0..1.

use core::iter;

use fcc_core::flight::Surfaces;

/// The values to write; `None` leaves a control unchanged.
#[derive(Clone, Copy)]
pub(crate) struct Deflections {
    /// Elevator, aileron, rudder.
    pub(crate) yoke: [Option<f32>; 3],
    pub(crate) throttle: Option<f32>,
    pub(crate) elevator_trim: Option<f32>,
}

impl Deflections {
    pub(crate) const CENTRED: Self = Self {
        yoke: [Some(0.0); 3],
        throttle: None,
        elevator_trim: None,
    };
    pub(crate) const AS_THEY_ARE: Self = Self {
        yoke: [None; 3],
        throttle: None,
        elevator_trim: None,
    };

    /// Limited to their ranges; NaN leaves a control unchanged. The loop has
    /// already checked its outputs; this is the last check before the aircraft.
    pub(crate) fn of(surfaces: &Surfaces) -> Self {
        Self {
            yoke: yoke_ratios(surfaces),
            throttle: ratio(surfaces.throttle, 0.0),
            elevator_trim: surfaces.elevator_trim.and_then(|trim| ratio(trim, -1.0)),
        }
    }

    /// Elevator, aileron, rudder, the throttle of every engine, then the
    /// elevator's trim, in as many writes.
    pub(crate) fn values(&self, writes: usize) -> impl Iterator<Item = Option<f32>> {
        let engines = writes.saturating_sub(4);
        let throttles = iter::repeat_n(self.throttle, engines);
        let trim = iter::once(self.elevator_trim);
        self.yoke.into_iter().chain(throttles).chain(trim)
    }
}

fn ratio(value: f64, least: f64) -> Option<f32> {
    (!value.is_nan()).then(|| value.clamp(least, 1.0) as f32)
}

/// What is written to the yoke for these surfaces: elevator, aileron, rudder.
pub(crate) fn yoke_ratios(surfaces: &Surfaces) -> [Option<f32>; 3] {
    [surfaces.elevator, surfaces.aileron, surfaces.rudder].map(|value| ratio(value, -1.0))
}
