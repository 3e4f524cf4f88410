//! Whether the biases of the inertial sensors change faster than they are expected to.
//!
//! Each correction of a state has an expected variance: that by which the covariance becomes
//! smaller. If the filter is consistent the corrections are white, and their sum over some
//! seconds has the sum of these variances. Corrections that go on in one direction show that
//! the state is less certain than the filter takes it for, and by how much (the noise of the
//! process from the corrections of the state: Myers and Tapley 1976, *Adaptive sequential
//! estimation with unknown noise statistics*, IEEE Transactions on Automatic Control 21).

use super::parameters as p;
use super::states::{FORCE_BIAS, RATE_BIAS, StateVector};

/// Biases of gyroscopes, of three axes, and of accelerometers forward and to the right: what is
/// off downwards tips no horizon, and may be an accelerometer at the end of its range.
const WATCHED: usize = 5;
const FIRST: usize = RATE_BIAS;
const _: () = assert!(
    FORCE_BIAS == RATE_BIAS + 3,
    "the biases are beside each other"
);

/// The corrections of the latest seconds: their sum, and its variance if they are white.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Drift {
    sums: [(f64, f64); WATCHED],
}

impl Drift {
    /// Takes the gain of a scalar measurement, and the covariance of what it measures with
    /// the states: their product is what the variances are expected to decrease by.
    pub(super) fn expect(&mut self, gain: &StateVector, with_states: &StateVector) {
        let of = |states: &StateVector| states.fixed_rows::<WATCHED>(FIRST).into_owned();
        let decrease = of(gain).component_mul(&of(with_states));
        for ((_, variance), decrease) in self.sums.iter_mut().zip(decrease.iter()) {
            *variance += decrease;
        }
    }

    /// Takes a correction of the states.
    pub(super) fn corrected(&mut self, by: &StateVector) {
        let by = by.fixed_rows::<WATCHED>(FIRST);
        for ((sum, _), by) in self.sums.iter_mut().zip(by.iter()) {
            *sum += by;
        }
    }

    /// Moves on by a time: by how much the variance of each bias has to grow in it.
    pub(super) fn step(&mut self, dt_s: f64) -> [f64; WATCHED] {
        let share = (dt_s / p::DRIFT_S).min(0.5);
        let mut sums = self.sums.iter_mut();
        [(); WATCHED].map(|()| {
            let Some((sum, variance)) = sums.next() else {
                return 0.0;
            };
            let beyond = *sum * *sum - p::SUM_GATE * *variance;
            *sum -= share * *sum;
            *variance -= 2.0 * share * *variance;
            p::DRIFT_GAIN * share * beyond.max(0.0)
        })
    }
}
