//! How well a filter agrees with what it is told.

use nalgebra::Vector3;

use super::super::{Innovation, ObservationKind};
use fcc_core::blocks::smoothing_factor;
use fcc_core::framework::Time;

/// What is averaged, s.
const MEAN_S: f64 = 2.0;
/// Innovations larger than so many standard deviations count as these.
const LARGEST: f64 = 10.0;
/// A filter contradicts a kind of sensor beyond this mean square and all of another filter's,
/// and beyond this many times the other's of this kind.
const CONTRADICTS: f64 = 3.0;
const CONTRADICTS_RATIO: f64 = 4.0;
/// A sensor that is silent for longer, s, says nothing.
const SILENT_S: f64 = 3.0;

/// A filter that needs biases as large as these is not consistent: the rates' and the specific
/// force's of a sensor that was calibrated are a third of it, rad/s (1 °/s), m/s².
const RATE_BIAS_RADPS: f64 = 0.0175;
const FORCE_BIAS_MPS2: f64 = 0.5;

/// The mean squares of the innovations of each kind of sensor over their variances, 1 of a
/// consistent filter, and the squares of the biases.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Consistency {
    /// Magnetic field, static pressure, airspeed, position, velocity; biases of rates and of
    /// specific force.
    kinds: [(f64, Time); 7],
}

impl Consistency {
    pub(super) fn add(&mut self, innovations: &[Innovation]) {
        for innovation in innovations {
            let place = match innovation.kind {
                ObservationKind::MagneticField => 0,
                ObservationKind::StaticPressure => 1,
                ObservationKind::DifferentialPressure | ObservationKind::Airspeed => 2,
                ObservationKind::Position => 3,
                ObservationKind::Velocity => 4,
                ObservationKind::Rates | ObservationKind::SpecificForce => continue,
            };
            if let Some((mean, latest)) = self.kinds.get_mut(place) {
                let dt_s = innovation.time.since(*latest).as_secs_f64();
                *mean += (square(innovation) - *mean) * smoothing_factor(dt_s.min(1.0), MEAN_S);
                *latest = innovation.time;
            }
        }
    }

    /// Takes the biases that the filter has found at a time, rad/s and m/s².
    pub(super) fn add_biases(&mut self, now: Time, [of_rates, of_force]: [[f64; 3]; 2]) {
        let squared = |of: [f64; 3], by: f64| Vector3::from(of).norm_squared() / (by * by);
        let [.., rates, force] = &mut self.kinds;
        *rates = (squared(of_rates, RATE_BIAS_RADPS), now);
        *force = (squared(of_force, FORCE_BIAS_MPS2), now);
    }

    /// Whether a filter contradicts some kind of sensor, and another does not.
    pub(super) fn contradicts(&self, other: &Self, now: Time) -> bool {
        let heard = |of: Time| !of.is_never() && now.since(of).as_secs_f64() < SILENT_S;
        let worst = other.kinds.iter().filter(|(_, at)| heard(*at));
        let least = worst.fold(CONTRADICTS, |worst, (mean, _)| worst.max(*mean));
        let mut kinds = self.kinds.iter().zip(&other.kinds);
        kinds.any(|((one, at), (other, _))| {
            heard(*at) && *one > least && *one > CONTRADICTS_RATIO * other
        })
    }
}

/// The square over its variance, of a vector the sum over its axes.
fn square(of: &Innovation) -> f64 {
    let axes = of.difference.iter().zip(of.sigma);
    axes.filter(|(_, sigma)| *sigma > 0.0)
        .map(|(difference, sigma)| (difference / sigma).clamp(-LARGEST, LARGEST))
        .map(|by| by * by)
        .sum()
}
