//! Errors that last: a standard deviation and a correlation time.

use nalgebra::SVector;

/// An error of a sensor: its standard deviation, and the time after which it is
/// another one. A Kalman filter takes errors for independent; what is
/// correlated over τ and comes every Δt carries as little as an independent
/// error with the variance σ² (1 + 2 τ/Δt) (the spectral density at frequency
/// zero of a Gauss-Markov process, 2 σ² τ; Gelb 1974, section 3.8).
#[derive(Clone, Copy, Debug)]
pub(super) struct Noise {
    pub(super) sigma: f64,
    pub(super) tau_s: f64,
}

impl Noise {
    pub(super) const fn new(sigma: f64, tau_s: f64) -> Self {
        Self { sigma, tau_s }
    }

    /// With a second, independent part.
    pub(super) fn plus(self, sigma: f64) -> Self {
        Self {
            sigma: libm::sqrt(self.sigma * self.sigma + sigma * sigma),
            ..self
        }
    }

    /// The variance of one sample, which an innovation is judged by.
    pub(super) fn variance(self) -> f64 {
        self.sigma * self.sigma
    }

    /// By how much the variance is larger for a sample `since_s` after the last
    /// one.
    pub(super) fn excess(self, since_s: f64) -> f64 {
        1.0 + 2.0 * self.tau_s / since_s.max(1e-3)
    }
}

/// The variances of one sample of three axes.
pub(super) fn variances(noises: [Noise; 3]) -> SVector<f64, 3> {
    SVector::from(noises.map(Noise::variance))
}
