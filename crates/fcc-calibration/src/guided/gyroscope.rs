//! The gyroscope's bias: what it gives at rest.

use core::time::Duration;

use super::readings::Arrived;
use super::rest::{Halves, Rest};
use super::{Collect, Found, Next, Quality, Refusal, Values};

/// For how long it is left alone.
const LENGTH: Duration = Duration::from_secs(10);
/// The largest standard deviation of a bias, rad/s: 0.05°/s.
const LARGEST_SIGMA_RADPS: f64 = 8.7e-4;
/// The zero of a gyroscope that is not calibrated is up to 20°/s (of the
/// MPU-3050, by its data sheet PS-MPU-3050A-00); what gives more is turning.
const LARGEST_BIAS_RADPS: f64 = 0.35;
/// Gravity and the magnetic field may turn by so much, rad: 0.3° and 0.5°.
const TILTED_RAD: f64 = 5e-3;
const TURNED_RAD: f64 = 8.7e-3;

/// Collects what a gyroscope gives at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct AtRest {
    rates: Halves<3>,
    force: Halves<3>,
    field: Halves<3>,
    interruptions: u32,
}

impl AtRest {
    pub(super) fn new() -> Self {
        let halves = || Halves::new(LENGTH);
        Self {
            rates: halves(),
            force: halves(),
            field: halves(),
            interruptions: 0,
        }
    }
}

impl AtRest {
    /// What the accelerometer and the gyroscope gave in the mean, once it is
    /// complete.
    pub(super) fn means(&self) -> Option<([f64; 3], [f64; 3])> {
        let means = (self.force.mean(), self.rates.mean());
        self.is_complete().then_some(means)
    }
}

impl Collect for AtRest {
    fn take(&mut self, arrived: &Arrived, rest: &Rest) {
        if self.is_complete() {
            return;
        }
        if !rest.is_given() {
            self.interruptions += u32::from(self.rates.has_begun());
            let interruptions = self.interruptions;
            *self = Self {
                interruptions,
                ..Self::new()
            };
            return;
        }
        let parts = [
            (&mut self.rates, arrived.rates),
            (&mut self.force, arrived.force),
            (&mut self.field, arrived.field),
        ];
        for (halves, given) in parts {
            if let Some(given) = given {
                halves.take(given, arrived.at);
            }
        }
    }

    fn progress(&self) -> f64 {
        self.rates.share()
    }

    fn is_complete(&self) -> bool {
        self.rates.is_full()
    }

    fn next(&self) -> Next {
        Next::LeaveAlone
    }

    fn finish(&self) -> Result<Found, Refusal> {
        if !self.is_complete() {
            return Err(Refusal::ended(self.interruptions, 0, 1));
        }
        for (halves, most_rad) in [(&self.force, TILTED_RAD), (&self.field, TURNED_RAD)] {
            let turned_rad = halves.turned_rad();
            if turned_rad > most_rad {
                return Err(Refusal::Turned { turned_rad });
            }
        }
        let bias = self.rates.mean();
        for (part, axis) in bias.into_iter().zip(0..) {
            if part.abs() > LARGEST_BIAS_RADPS {
                return Err(Refusal::TooLarge {
                    axis,
                    given: part,
                    most: LARGEST_BIAS_RADPS,
                });
            }
        }
        // A difference between the halves that noise does not explain.
        let sigma = self.rates.mean_sigma().max(0.5 * self.rates.change());
        Ok(Found {
            values: Values::GyroscopeBias { bias_radps: bias },
            quality: Quality::within(sigma, LARGEST_SIGMA_RADPS)?,
            sigma,
        })
    }
}
