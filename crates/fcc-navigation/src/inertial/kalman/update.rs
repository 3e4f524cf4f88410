//! How a measurement corrects the state: gate, gain, covariance.

use nalgebra::{SMatrix, SVector};

use super::filter::Filter;
use super::innovations::Innovation;
use super::states::{ATTITUDE, BODY_FIELD, EARTH_FIELD, LATENESS, RATE_BIAS, STATES, StateVector};
use crate::inertial::ObservationKind;
use fcc_core::framework::Time;

/// What is measured of `N` axes, and how it depends on the error of the state.
pub(super) struct Measurement<const N: usize> {
    /// Measured minus expected.
    pub(super) difference: SVector<f64, N>,
    /// The derivative of the measurement by the error of the state.
    pub(super) jacobian: SMatrix<f64, N, STATES>,
    /// Of one sample.
    pub(super) variance: SVector<f64, N>,
    /// By how much that is larger for the filter, because errors last.
    pub(super) excess: SVector<f64, N>,
}

impl<const N: usize> Measurement<N> {
    fn distance(&self, covariance: &SMatrix<f64, N, N>) -> f64 {
        covariance.try_inverse().map_or(f64::INFINITY, |inverse| {
            self.difference.dot(&(inverse * self.difference))
        })
    }
}

/// Which states a measurement corrects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corrects {
    All,
    /// By how much fixes are late is considered, and not told by them.
    AllButLateness,
    /// The same of a heading that is not known: what it changes is not linear in an error
    /// of 90° and more. The course tells it at once as soon as this moves.
    AllButHeading,
    /// A compass says nothing of the horizon: near iron it would tip it. The
    /// other states are considered with their uncertainty, and stay (Schmidt
    /// 1966).
    Heading,
}

impl Corrects {
    fn mask(self, gain: &mut StateVector) {
        if matches!(self, Self::AllButLateness | Self::AllButHeading) {
            gain[LATENESS] = 0.0;
        }
        if self == Self::AllButHeading {
            gain[ATTITUDE + 2] = 0.0;
        }
        if self != Self::Heading {
            return;
        }
        for at in 0..STATES {
            let is_free = at == ATTITUDE + 2
                || (RATE_BIAS..RATE_BIAS + 3).contains(&at)
                || (EARTH_FIELD..BODY_FIELD + 3).contains(&at);
            if !is_free {
                gain[at] = 0.0;
            }
        }
    }
}

impl Filter {
    /// How far a measurement is from what is expected, as the square of a number
    /// of standard deviations, for each of its axes: a consistent one has a mean
    /// of `N`, and is distributed as χ². Infinite if it cannot be said.
    pub(super) fn distance<const N: usize>(&self, measurement: &Measurement<N>) -> f64 {
        measurement.distance(&self.innovation_covariance(measurement))
    }

    fn innovation_covariance<const N: usize>(
        &self,
        measurement: &Measurement<N>,
    ) -> SMatrix<f64, N, N> {
        let jacobian = &measurement.jacobian;
        let mut with_states = SMatrix::<f64, STATES, N>::zeros();
        for axis in 0..N {
            let row = jacobian.row(axis).transpose();
            with_states.set_column(axis, &self.with_states(&row));
        }
        let mut covariance = jacobian * with_states;
        for axis in 0..N {
            covariance[(axis, axis)] += measurement.variance[axis];
        }
        covariance
    }

    /// The covariance of the states and what a row of a Jacobian measures of them: of a
    /// few, so most parts of the row are zero.
    fn with_states(&self, row: &StateVector) -> StateVector {
        let mut with_states = StateVector::zeros();
        for (at, &part) in row.iter().enumerate() {
            if part != 0.0 {
                with_states.axpy(part, &self.covariance.column(at), 1.0);
            }
        }
        with_states
    }

    /// Corrects the state, axis after axis.
    pub(super) fn correct<const N: usize>(
        &mut self,
        measurement: &Measurement<N>,
        corrects: Corrects,
    ) {
        let mut error = StateVector::zeros();
        let watches = corrects != Corrects::Heading && self.is_moving();
        for axis in 0..N {
            let row = measurement.jacobian.row(axis).transpose();
            let variance = measurement.variance[axis] * measurement.excess[axis];
            let with_states = self.with_states(&row);
            let total = row.dot(&with_states) + variance;
            if total <= 0.0 {
                continue;
            }
            let mut gain = with_states / total;
            corrects.mask(&mut gain);
            if watches {
                self.drift.expect(&gain, &with_states);
            }
            let left = measurement.difference[axis] - row.dot(&error);
            error += gain * left;
            // (I - K H) P (I - K H)ᵀ + K R Kᵀ, for any gain (Joseph's form), is
            // P - K Lᵀ - L Kᵀ with L = P Hᵀ - ½ (H P Hᵀ + R) K.
            let less = with_states - gain * (0.5 * total);
            let (gain, less) = (gain.as_slice(), less.as_slice());
            let columns = self.covariance.as_mut_slice().chunks_exact_mut(STATES);
            for (column, (gain_here, less_here)) in columns.zip(gain.iter().zip(less)) {
                for (part, (gain, less)) in column.iter_mut().zip(gain.iter().zip(less)) {
                    *part -= gain * less_here + less * gain_here;
                }
            }
        }
        if watches {
            self.drift.corrected(&error);
        }
        self.inject(&error);
    }

    /// Judges a measurement of a sensor, corrects the state with a plausible one,
    /// and notes the innovation. False if it is refused.
    pub(super) fn fuse<const N: usize>(
        &mut self,
        kind: ObservationKind,
        taken: Time,
        measurement: &Measurement<N>,
        gate: f64,
        corrects: Corrects,
    ) -> bool {
        self.settle();
        let covariance = self.innovation_covariance(measurement);
        let accepted = measurement.distance(&covariance) <= gate;
        self.note(kind, taken, measurement, &covariance, accepted);
        self.tracks.of(kind).judged(taken, accepted);
        if accepted {
            self.correct(measurement, corrects);
        }
        accepted
    }

    fn note<const N: usize>(
        &mut self,
        kind: ObservationKind,
        taken: Time,
        measurement: &Measurement<N>,
        covariance: &SMatrix<f64, N, N>,
        accepted: bool,
    ) {
        let (mut difference, mut sigma) = ([0.0; 3], [0.0; 3]);
        for (axis, (difference, sigma)) in difference.iter_mut().zip(&mut sigma).take(N).enumerate()
        {
            *difference = measurement.difference[axis];
            *sigma = libm::sqrt(covariance[(axis, axis)]);
        }
        self.innovations.push(Innovation {
            time: taken,
            kind,
            difference,
            sigma,
            accepted,
        });
    }
}
