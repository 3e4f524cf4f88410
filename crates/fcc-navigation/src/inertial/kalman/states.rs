//! Where the parts of the error of the state are.

use nalgebra::{SMatrix, SVector};

/// Number of states.
pub(super) const STATES: usize = 25;
pub(super) type Covariance = SMatrix<f64, STATES, STATES>;
pub(super) type StateVector = SVector<f64, STATES>;

/// Where each part of the error begins: the attitude's is a rotation vector in
/// north, east, down.
pub(super) const ATTITUDE: usize = 0;
pub(super) const VELOCITY: usize = 3;
pub(super) const POSITION: usize = 6;
pub(super) const RATE_BIAS: usize = 9;
pub(super) const FORCE_BIAS: usize = 12;
pub(super) const BAROMETER_BIAS: usize = 15;
pub(super) const EARTH_FIELD: usize = 16;
pub(super) const BODY_FIELD: usize = 19;
pub(super) const WIND: usize = 22;
pub(super) const LATENESS: usize = 24;

/// An angle is never less certain than one of which nothing is known: the
/// variance of a uniform one, π²/3.
pub(super) const UNKNOWN_ANGLE: f64 = 3.29;
