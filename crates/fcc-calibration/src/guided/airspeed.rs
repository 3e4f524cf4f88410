//! The zero of a pitot tube: what it gives without wind.

use core::time::Duration;

use super::readings::Arrived;
use super::rest::{Halves, Rest};
use super::{Collect, Found, Next, Quality, Refusal, Values};

/// For how long it is left alone.
const LENGTH: Duration = Duration::from_secs(10);
/// A zero beyond it is none, Pa: an airspeed of 13 m/s.
const LARGEST_BIAS_PA: f64 = 100.0;
/// The largest error of the zero, Pa: 1 m/s at 4 m/s, 0.1 m/s at 25 m/s.
const LARGEST_SIGMA_PA: f64 = 3.0;
/// Over the ground, m/s.
const MOVING_MPS: f64 = 1.0;

/// Collects what a pitot tube gives without wind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Zero {
    pressure: Halves<1>,
    interruptions: u32,
    is_moving: bool,
}

impl Zero {
    pub(super) fn new() -> Self {
        Self {
            pressure: Halves::new(LENGTH),
            interruptions: 0,
            is_moving: false,
        }
    }
}

impl Collect for Zero {
    fn take(&mut self, arrived: &Arrived, rest: &Rest) {
        if self.is_complete() {
            return;
        }
        if let Some(fix) = &arrived.gnss {
            let speed_mps = libm::hypot(fix.velocity.north_mps, fix.velocity.east_mps);
            self.is_moving = speed_mps > MOVING_MPS.max(3.0 * fix.speed_accuracy_mps);
        }
        if !rest.is_given() || self.is_moving {
            self.interruptions += u32::from(self.pressure.has_begun());
            self.pressure.clear();
        } else if let Some(given) = arrived.differential_pa {
            self.pressure.take([given], arrived.at);
        }
    }

    fn progress(&self) -> f64 {
        self.pressure.share()
    }

    fn is_complete(&self) -> bool {
        self.pressure.is_full()
    }

    fn next(&self) -> Next {
        Next::CoverTube
    }

    fn finish(&self) -> Result<Found, Refusal> {
        if !self.is_complete() {
            return Err(Refusal::ended(self.interruptions, 0, 1));
        }
        let [bias_pa] = self.pressure.mean();
        if bias_pa.abs() > LARGEST_BIAS_PA {
            return Err(Refusal::TooLarge {
                axis: 0,
                given: bias_pa,
                most: LARGEST_BIAS_PA,
            });
        }
        let sigma = self.pressure.mean_sigma().max(0.5 * self.pressure.change());
        Ok(Found {
            values: Values::Airspeed { bias_pa },
            quality: Quality::within(sigma, LARGEST_SIGMA_PA)?,
            sigma,
        })
    }
}
