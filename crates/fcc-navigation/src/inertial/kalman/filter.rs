//! The state of the filter, its covariance, and how both move on.

use nalgebra::{Matrix3, SMatrix, Vector2, Vector3};

use super::displacement::Displacement;
use super::drift::Drift;
use super::in_flight::InFlight;
use super::innovations::Innovations;
use super::motion::{Increment, Inertial, Motion, Raw, turn};
use super::parameters as p;
use super::path::Path;
use super::scatter::Scatter;
use super::states::{
    ATTITUDE, BAROMETER_BIAS, BODY_FIELD, Covariance, EARTH_FIELD, FORCE_BIAS, LATENESS, POSITION,
    RATE_BIAS, STATES, StateVector, UNKNOWN_ANGLE, VELOCITY, WIND,
};
use super::track::Tracks;
use super::trend::Trend;
use fcc_core::framework::Time;

/// The first of them: those that others change as time passes, and with those that
/// change them.
const MOVED: usize = RATE_BIAS;
const MOVING: usize = BAROMETER_BIAS;

/// The covariance moves on in steps of at least this, s.
const COVARIANCE_S: f64 = 0.008;
/// Inertial samples further apart than this are not connected, s.
pub(in crate::inertial) const GAP_S: f64 = 0.2;
/// Corrections below this turn the covariance by nothing, rad.
const SMALL_TURN: f64 = 1e-3;

/// What the filter knows.
#[derive(Clone, Debug)]
pub(super) struct Filter {
    pub(super) time: Time,
    pub(super) motion: Motion,
    pub(super) rate_bias: Vector3<f64>,
    pub(super) force_bias: Vector3<f64>,
    pub(super) barometer_bias: f64,
    pub(super) earth_field: Vector3<f64>,
    pub(super) body_field: Vector3<f64>,
    pub(super) wind: Vector2<f64>,
    /// By how much fixes are later than they say, s.
    pub(super) late_s: f64,
    pub(super) covariance: Covariance,
    pub(super) tracks: Tracks,
    pub(super) innovations: Innovations,
    /// The acceleration over the ground and the rates of the last step, without
    /// their biases.
    pub(super) acceleration: Vector3<f64>,
    pub(super) rates: Vector3<f64>,
    /// Whether that step had rates: without them it may turn in any way.
    pub(super) knows_rates: bool,
    /// The mean square of the horizontal velocity, m²/s².
    pub(super) mean_square_velocity: f64,
    /// Whether what is taken for rates is how the magnetic field turns.
    pub(super) turns_by_field: bool,
    pub(super) drift: Drift,
    pub(super) trend: Trend,
    pub(super) path: Path,
    pub(super) in_flight: InFlight,
    pub(super) displacement: Displacement,
    pub(super) scatter: Scatter,
    /// When this filter last took a velocity for its own that it had refused.
    pub(super) taken_over: Time,
    /// The mean specific force, m/s², and when it was last so large that it may be more.
    load: f64,
    /// The rates of the last step that had some, less the longer that is ago, rad/s.
    turning: f64,
    pub(super) rough: Time,
    /// When it was last slower than anything flies.
    pub(super) slow: Time,
    /// How a receiver last said that this moves, and when, m/s: also if that was refused.
    pub(super) receiver: (Time, Vector3<f64>),
    /// When a receiver last contradicted the air.
    pub(super) contradicted: Time,
    /// The wind of the latest seconds.
    pub(super) mean_wind: Vector2<f64>,
    /// Whether another filter tells which of two sensors is wrong.
    pub(super) is_compared: bool,
    pending: Pending,
}

/// What has happened since the covariance moved on.
#[derive(Clone, Copy, Debug, Default)]
struct Pending {
    dt_s: f64,
    turned_s: Matrix3<f64>,
    velocity: Vector3<f64>,
    attitude_variance: f64,
    velocity_variance: f64,
    rate_bias_variance: f64,
}

impl Pending {
    /// The transpose of F times a matrix whose columns are of the states. F is the
    /// identity but for three blocks: the biases act on attitude and velocity, attitude
    /// on velocity, velocity on position.
    fn move_columns<const ROWS: usize, const COLUMNS: usize>(
        &self,
        matrix: &mut SMatrix<f64, ROWS, COLUMNS>,
    ) {
        let columns = |matrix: &SMatrix<f64, ROWS, COLUMNS>, at: usize| {
            matrix.fixed_columns::<3>(at).into_owned()
        };
        let from_attitude = -self.velocity.cross_matrix().transpose();
        let from_biases = -self.turned_s.transpose();
        let velocity = columns(matrix, VELOCITY) * self.dt_s;
        let mut position = matrix.fixed_columns_mut::<3>(POSITION);
        position += velocity;
        let by_biases = columns(matrix, FORCE_BIAS) * from_biases;
        let by_attitude = columns(matrix, ATTITUDE) * from_attitude;
        let mut velocity = matrix.fixed_columns_mut::<3>(VELOCITY);
        velocity += by_attitude + by_biases;
        let by_biases = columns(matrix, RATE_BIAS) * from_biases;
        let mut attitude = matrix.fixed_columns_mut::<3>(ATTITUDE);
        attitude += by_biases;
    }
}

impl Filter {
    pub(super) fn new() -> Self {
        Self {
            time: Time::NEVER,
            motion: Motion::new(),
            rate_bias: Vector3::zeros(),
            force_bias: Vector3::zeros(),
            barometer_bias: 0.0,
            earth_field: Vector3::zeros(),
            body_field: Vector3::zeros(),
            wind: Vector2::zeros(),
            late_s: 0.0,
            covariance: Covariance::zeros(),
            tracks: Tracks::default(),
            innovations: Innovations::default(),
            acceleration: Vector3::zeros(),
            rates: Vector3::zeros(),
            knows_rates: false,
            mean_square_velocity: 0.0,
            turns_by_field: false,
            drift: Drift::default(),
            trend: Trend::default(),
            path: Path::new(),
            in_flight: InFlight::new(),
            displacement: Displacement::default(),
            scatter: Scatter::default(),
            taken_over: Time::NEVER,
            load: 0.0,
            turning: 0.0,
            rough: Time::NEVER,
            slow: Time::NEVER,
            receiver: (Time::NEVER, Vector3::zeros()),
            contradicted: Time::NEVER,
            mean_wind: Vector2::zeros(),
            is_compared: false,
            pending: Pending::default(),
        }
    }

    /// Moves on by `dt_s` with an inertial reading whose biases are still in it.
    pub(super) fn advance(&mut self, raw: &Raw, dt_s: f64) {
        let reading = self.without_bias(raw);
        self.rates = reading.rates;
        self.knows_rates = raw.rates.is_some();
        self.turning = if self.knows_rates {
            self.rates.norm()
        } else {
            self.turning * (1.0 - fcc_core::blocks::smoothing_factor(dt_s, p::TURNING_S))
        };
        let increment = self.motion.advance(&reading, dt_s);
        let biases = [self.rate_bias, self.force_bias];
        self.in_flight
            .advance(self.time, raw, increment.half, biases, dt_s);
        self.acceleration = increment.acceleration;
        let load = reading.force.map_or(0.0, |force| force.norm());
        self.load += fcc_core::blocks::smoothing_factor(dt_s, p::LOAD_S) * (load - self.load);
        if self.load > p::ROUGH {
            self.rough = self.time;
        }
        self.path.keep(self.time, &self.motion);
        self.accumulate(&increment, raw, dt_s);
        let horizontal = self.motion.velocity.xy().norm_squared();
        let share = fcc_core::blocks::smoothing_factor(dt_s, p::VELOCITY_S);
        self.mean_square_velocity += share * (horizontal - self.mean_square_velocity);
        let share = fcc_core::blocks::smoothing_factor(dt_s, p::MEAN_WIND_S);
        self.mean_wind += (self.wind - self.mean_wind) * share;
        if self.pending.dt_s >= COVARIANCE_S {
            self.settle();
        }
    }

    pub(super) fn without_bias(&self, raw: &Raw) -> Inertial {
        Inertial {
            rates: raw
                .rates
                .map_or(Vector3::zeros(), |rates| rates - self.rate_bias),
            force: raw.force.map(|force| force - self.force_bias),
        }
    }

    fn accumulate(&mut self, by: &Increment, raw: &Raw, dt_s: f64) {
        let is_aided = self.is_aided();
        let pending = &mut self.pending;
        pending.dt_s += dt_s;
        pending.turned_s += self.motion.attitude.to_rotation_matrix().matrix() * dt_s;
        pending.velocity += by.velocity;
        let rate_density = if self.turns_by_field {
            2.0 * p::FIELD_RATE * p::FIELD_RATE * p::FIELD_RATE_S
        } else if raw.rates.is_some() {
            let per_radian = 2.0 * p::RATE_SCALE * p::RATE_SCALE * p::ONE_WAY_RAD;
            p::RATE_NOISE * p::RATE_NOISE + per_radian * self.rates.norm()
        } else {
            let square = p::UNKNOWN_RATE * p::UNKNOWN_RATE + self.turning * self.turning;
            2.0 * square * p::UNKNOWN_RATE_S
        };
        let force_density = if raw.force.is_some() {
            let scale = p::FORCE_SCALE * by.acceleration.norm();
            p::FORCE_NOISE * p::FORCE_NOISE + 2.0 * scale * scale * p::FORCE_SCALE_S
        } else {
            2.0 * p::UNKNOWN_FORCE * p::UNKNOWN_FORCE * p::UNKNOWN_FORCE_S
        };
        pending.attitude_variance += rate_density * dt_s;
        pending.velocity_variance += force_density * dt_s;
        let by_acceleration = if is_aided {
            0.0
        } else {
            p::RATE_BIAS_WALK_BY_ACCELERATION * by.acceleration.norm()
        };
        pending.rate_bias_variance +=
            (p::RATE_BIAS_WALK * p::RATE_BIAS_WALK + by_acceleration * by_acceleration) * dt_s;
    }

    /// Moves the covariance on to the time of the state: F P Fᵀ + Q (Solà 2017,
    /// section 7.2 with the attitude's error in earth axes).
    pub(super) fn settle(&mut self) {
        let pending = core::mem::take(&mut self.pending);
        let dt_s = pending.dt_s;
        if dt_s <= 0.0 {
            return;
        }
        self.propagate(&pending);
        let walk = |sigma: f64| sigma * sigma * dt_s;
        self.add_variance(ATTITUDE, 3, pending.attitude_variance);
        self.add_variance(VELOCITY, 3, pending.velocity_variance);
        self.add_variance(RATE_BIAS, 3, pending.rate_bias_variance);
        self.add_variance(FORCE_BIAS, 3, walk(p::FORCE_BIAS_WALK));
        if self.begins_to_fly() {
            self.add_variance(FORCE_BIAS + 2, 1, walk(p::SHAKEN_BIAS_WALK));
        }
        self.add_variance(BAROMETER_BIAS, 1, walk(p::BAROMETER_WALK));
        self.add_variance(EARTH_FIELD, 3, walk(p::EARTH_FIELD_WALK));
        self.add_variance(BODY_FIELD, 3, walk(p::BODY_FIELD_WALK));
        self.add_variance(WIND, 2, walk(self.wind_walk()));
        self.add_variance(LATENESS, 1, walk(p::LATENESS_WALK));
        for (at, more) in (RATE_BIAS..).zip(self.drift.step(dt_s)) {
            if more > 0.0 {
                self.add_variance(at, 1, more);
                let largest = if at < FORCE_BIAS {
                    p::LARGEST_RATE_BIAS
                } else {
                    p::LARGEST_FORCE_BIAS
                };
                self.limit_variance(at, largest * largest);
            }
        }
        for axis in ATTITUDE..ATTITUDE + 3 {
            self.limit_variance(axis, UNKNOWN_ANGLE);
        }
        for axis in WIND..WIND + 2 {
            self.limit_variance(axis, p::LARGEST_WIND * p::LARGEST_WIND);
        }
    }

    /// F P Fᵀ: P Fᵀ first, by columns, which are together in memory; then F times that,
    /// of the states that F changes; the other rows are the columns.
    fn propagate(&mut self, by: &Pending) {
        by.move_columns(&mut self.covariance);
        let mut moved: SMatrix<f64, MOVED, MOVING> = self
            .covariance
            .fixed_view::<MOVING, MOVED>(0, 0)
            .transpose();
        by.move_columns(&mut moved);
        for column in 0..STATES {
            for row in 0..MOVED {
                self.covariance[(row, column)] = if column < MOVED {
                    moved[(column, row)]
                } else {
                    self.covariance[(column, row)]
                };
            }
        }
    }

    /// The random walk of the wind, m/s/√s: turbulence that it flies through.
    fn wind_walk(&self) -> f64 {
        let airspeed = (self.motion.velocity.xy() - self.wind).norm();
        p::TURBULENCE * libm::sqrt(2.0 * airspeed / p::TURBULENCE_LENGTH_M)
    }

    pub(super) fn add_variance(&mut self, from: usize, count: usize, variance: f64) {
        for at in from..from + count {
            self.covariance[(at, at)] += variance;
        }
    }

    /// Limits a variance; correlations stay.
    fn limit_variance(&mut self, at: usize, largest: f64) {
        let variance = self.covariance[(at, at)];
        if variance > largest {
            let factor = libm::sqrt(largest / variance);
            self.covariance.row_mut(at).scale_mut(factor);
            self.covariance.column_mut(at).scale_mut(factor);
        }
    }

    /// Forgets what was known of some states: variances instead.
    pub(super) fn reset_covariance(&mut self, from: usize, count: usize, variance: f64) {
        for at in from..from + count {
            self.covariance.row_mut(at).fill(0.0);
            self.covariance.column_mut(at).fill(0.0);
            self.covariance[(at, at)] = variance;
        }
    }

    /// Corrects the state by an error, and turns the attitude's part of the
    /// covariance with it (Solà 2017, section 7.3: I + ½ [δθ]×).
    pub(super) fn inject(&mut self, error: &StateVector) {
        let part = |at: usize| error.fixed_rows::<3>(at).into_owned();
        let angle = part(ATTITUDE);
        self.motion.attitude = turn(angle) * self.motion.attitude;
        self.motion.attitude.renormalize_fast();
        self.motion.velocity += part(VELOCITY);
        self.motion.shift(part(POSITION));
        self.path.corrected(part(POSITION), part(VELOCITY));
        self.rate_bias += part(RATE_BIAS);
        self.force_bias += part(FORCE_BIAS);
        self.barometer_bias += error[BAROMETER_BIAS];
        self.earth_field += part(EARTH_FIELD);
        self.body_field += part(BODY_FIELD);
        self.wind += error.fixed_rows::<2>(WIND);
        self.late_s =
            (self.late_s + error[LATENESS]).clamp(-p::LARGEST_LATENESS, p::LARGEST_LATENESS);
        if angle.norm() > SMALL_TURN {
            let reset = Matrix3::identity() + 0.5 * angle.cross_matrix();
            for _ in 0..2 {
                let rows = reset * self.covariance.fixed_rows::<3>(ATTITUDE);
                self.covariance
                    .fixed_rows_mut::<3>(ATTITUDE)
                    .copy_from(&rows);
                self.covariance.transpose_mut();
            }
        }
    }

    /// Rotation from body to earth axes.
    pub(super) fn rotation(&self) -> Matrix3<f64> {
        *self.motion.attitude.to_rotation_matrix().matrix()
    }

    /// The standard deviation of a state.
    pub(super) fn sigma(&self, at: usize) -> f64 {
        libm::sqrt(self.covariance[(at, at)].max(0.0))
    }
}
