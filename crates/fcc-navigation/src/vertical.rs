//! Altitude and climb rate from the barometer and the accelerometers.

use core::time::Duration;

use libm::{cos, sin, tan};

use super::attitude::Orientation;
use super::marked_altitude::MarkedAltitude;
use super::resolution::Resolution;
use super::sample_tracker::{NewSample, SampleTracker, is_current};
use super::vertical_covariance::{Gains, VerticalCovariance};
use fcc_core::blocks::limit_abs;
use fcc_core::flight::Measurements;
use fcc_core::framework::Time;
use fcc_core::units::GRAVITY_MPS2;

/// Altitude and climb rate.
#[derive(Clone, Copy, Debug, Default)]
pub struct VerticalState {
    /// Pressure altitude, m.
    pub altitude_m: f64,
    /// Up, m/s.
    pub climb_rate_mps: f64,
}

/// The climb rate, m/s, that a filter without an altimeter follows, and the bandwidth, rad/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reference(pub(super) f64, pub(super) f64);

/// Kalman filter: vertical acceleration integrated twice, corrected by
/// barometric altitude, with an estimate of the accelerometer's bias (the
/// barometric-inertial loop of Blanchard 1971, its gains from the covariance as
/// in Gelb 1974, table 4.2-1). It begins with a high bandwidth, without prior
/// knowledge, and settles at its final bandwidth.
///
/// An altitude can be marked: later measurements still carry information about
/// it, and refine the marked altitude (a fixed-point smoother, Gelb 1974,
/// section 5.3).
///
/// The readings of a coarse altimeter are no noise: the estimate is free within
/// half a step of them, and corrected by the moments in which they change.
///
/// ```
/// use fcc_core::flight::Measurements;
/// use fcc_navigation::{AttitudeChannel, VerticalChannel};
/// use fcc_core::framework::{Reading, Time};
///
/// let mut attitude = AttitudeChannel::new(1.36, 1.44);
/// let mut vertical = VerticalChannel::new(0.68);
/// let mut climb_rate_mps = 0.0;
/// // A barometer that rises by 2.5 m/s, for a minute.
/// for n in 1..=2_400 {
///     let now = Time::from_nanos(n * 25_000_000);
///     let measured = Measurements {
///         altitude_m: Reading::new(900.0 + 2.5 * 0.025 * n as f64, now),
///         ..Measurements::default()
///     };
///     let level = attitude.step(now, &measured, 0.025);
///     climb_rate_mps = vertical.step(now, &measured, &level, 0.025).climb_rate_mps;
/// }
/// assert!((climb_rate_mps - 2.5).abs() < 0.01);
/// ```
#[derive(Clone, Debug)]
pub struct VerticalChannel {
    state: VerticalState,
    bias_mps2: f64,
    covariance: VerticalCovariance,
    mark: Option<MarkedAltitude>,
    news: SampleTracker,
    resolution: Resolution,
    /// The vertical acceleration that was integrated last, up, m/s².
    felt_mps2: f64,
    /// Consecutive samples that are this far above or below, see [`JUMPED_M`].
    beyond: i8,
    has_stepped: bool,
    /// By how much those of the second before them differed, m; none after a gap, in which
    /// a climb may not have been known.
    before_m: Option<f64>,
    /// For how long none has jumped, s.
    quiet_s: f64,
}

/// An altimeter has stepped that differs by this more than in the second before, m, and by
/// so many standard deviations, in so many consecutive samples: what contradicts it otherwise
/// grows slowly. Its altitude is adopted then: a correction would find a climb and a bias of
/// the accelerometers that are none.
const STEPPED_SAMPLES: i8 = 3;
const JUMPED_M: f64 = 2.5;
const JUMPED_SDS: f64 = 3.0;
const BEFORE_S: f64 = 1.0;
/// One that jumps again within this time, s, is slow or noisy, and what it differs by is a
/// climb.
const QUIET_S: f64 = 10.0;

/// The largest bias of an intact accelerometer, m/s².
const MAX_BIAS_MPS2: f64 = 2.0;

/// The coarsest altimeter that is flown, m: one with three digits, 100 ft.
const COARSEST_M: f64 = 30.48;

/// A smaller step is less than the barometer's noise, m.
const LEAST_STEP_M: f64 = 0.5;

impl VerticalChannel {
    /// A filter in its initial state; `bandwidth_radps` in rad/s.
    pub const fn new(bandwidth_radps: f64) -> Self {
        Self {
            state: VerticalState {
                altitude_m: 0.0,
                climb_rate_mps: 0.0,
            },
            bias_mps2: 0.0,
            covariance: VerticalCovariance::new(bandwidth_radps),
            mark: None,
            news: SampleTracker::new(),
            resolution: Resolution::new(COARSEST_M),
            felt_mps2: 0.0,
            beyond: 0,
            has_stepped: false,
            before_m: None,
            quiet_s: QUIET_S,
        }
    }

    /// Whether the altimeter's last sample was found to follow a step.
    pub(super) const fn has_stepped(&self) -> bool {
        self.has_stepped
    }

    /// The vertical acceleration by the accelerometers, up, m/s².
    pub(super) const fn felt_mps2(&self) -> f64 {
        self.felt_mps2
    }

    /// What is known of the altimeter's resolution.
    pub(super) const fn resolution(&self) -> &Resolution {
        &self.resolution
    }

    /// The sensor is the same as that of `other`.
    pub(super) const fn keep_resolution(&mut self, other: &Self) {
        self.resolution = other.resolution;
    }

    /// Processes the measurements; returns altitude and climb rate.
    pub fn step(
        &mut self,
        now: Time,
        measurements: &Measurements,
        orientation: &Orientation,
        dt_s: f64,
    ) -> VerticalState {
        self.integrate(now, measurements, orientation, dt_s);
        let measured = measurements.altitude_m;
        let sample = self.news.of(&measured, dt_s);
        let known = self.resolution.step();
        let change = match sample {
            NewSample::None => 0.0,
            NewSample::First | NewSample::Next(_) => {
                self.resolution.take(&measured, |is, was| is - was)
            }
        };
        let step_m = self.resolution.step();
        self.has_stepped = false;
        match sample {
            NewSample::None => {}
            NewSample::First => self.begin(measured.value),
            NewSample::Next(since_s) if step_m > LEAST_STEP_M => {
                if known <= LEAST_STEP_M {
                    self.covariance.widen(step_m);
                }
                self.correct_coarse(measured.value, change, since_s);
            }
            NewSample::Next(since_s) => {
                let gains = self.covariance.correct(since_s);
                let error_m = measured.value - self.state.altitude_m;
                if !self.may_have_stepped(error_m, &gains, since_s) {
                    self.correct(error_m, &gains);
                } else if self.beyond.abs() >= STEPPED_SAMPLES {
                    (self.beyond, self.before_m) = (0, None);
                    self.has_stepped = true;
                    self.state.altitude_m = measured.value;
                    if let Some(mark) = &mut self.mark {
                        mark.keep();
                    }
                }
            }
        }
        self.state
    }

    /// Whether the altimeter differs as after a step; counts such samples.
    fn may_have_stepped(&mut self, error_m: f64, gains: &Gains, since_s: f64) -> bool {
        let before_m = self.before_m.unwrap_or(error_m);
        let jump_m = error_m - before_m;
        let jumps =
            jump_m * jump_m > JUMPED_M * JUMPED_M + JUMPED_SDS * JUMPED_SDS * gains.variance_m2();
        let has_jumped = jumps && (self.quiet_s >= QUIET_S || self.beyond != 0);
        self.quiet_s = if jumps { 0.0 } else { self.quiet_s + since_s };
        if !has_jumped {
            self.before_m = Some(before_m + jump_m * (since_s / BEFORE_S).min(1.0));
            self.beyond = 0;
            return false;
        }
        let side = if jump_m > 0.0 { 1 } else { -1 };
        self.beyond = if self.beyond.signum() == side {
            self.beyond + side
        } else {
            side
        };
        true
    }

    /// The same without an altimeter: climb rate or altitude follow another one,
    /// with equal poles; none is the accelerometers alone.
    pub(super) fn step_without_altimeter(
        &mut self,
        now: Time,
        measurements: &Measurements,
        orientation: &Orientation,
        reference: Option<Reference>,
        dt_s: f64,
    ) {
        self.integrate(now, measurements, orientation, dt_s);
        self.news.of(&measurements.altitude_m, dt_s);
        self.has_stepped = false;
        let state = &mut self.state;
        let towards = match reference {
            Some(Reference(climb_rate_mps, pole)) => {
                let error_mps = climb_rate_mps - state.climb_rate_mps;
                state.climb_rate_mps += 2.0 * pole * error_mps * dt_s;
                pole * pole * error_mps
            }
            None => 0.0,
        };
        self.bias_mps2 = limit_abs(self.bias_mps2 - towards * dt_s, MAX_BIAS_MPS2);
    }

    /// Integrates the vertical acceleration.
    fn integrate(
        &mut self,
        now: Time,
        measurements: &Measurements,
        orientation: &Orientation,
        dt_s: f64,
    ) {
        let measured = is_current(&measurements.specific_force, now);
        self.felt_mps2 = if measured {
            let force = measurements.specific_force.value;
            let (sin_roll, cos_roll) = (sin(orientation.roll_rad), cos(orientation.roll_rad));
            let (sin_pitch, cos_pitch) = (sin(orientation.pitch_rad), cos(orientation.pitch_rad));
            let up = force.x_mps2 * sin_pitch
                - cos_pitch * (force.y_mps2 * sin_roll + force.z_mps2 * cos_roll);
            up - GRAVITY_MPS2 - self.bias_mps2
        } else {
            0.0
        };
        if self.resolution.step() > LEAST_STEP_M {
            self.covariance
                .predict_coarse(tan(orientation.roll_rad), dt_s);
        }
        self.predict(self.felt_mps2, measured, dt_s);
    }

    /// The state, and the accelerometer's bias in m/s².
    pub(super) const fn state(&self) -> (VerticalState, f64) {
        (self.state, self.bias_mps2)
    }

    /// Replaces the state and the bias.
    pub(super) const fn adopt(&mut self, state: VerticalState, bias_mps2: f64) {
        (self.state, self.bias_mps2) = (state, bias_mps2);
        self.before_m = None;
    }

    /// Adopts an altitude, m; climb rate and bias are kept.
    pub(super) const fn adopt_altitude(&mut self, altitude_m: f64) {
        self.state.altitude_m = altitude_m;
        self.covariance.restart();
        self.before_m = None;
    }

    pub(super) fn postpone(&mut self, by: Duration, latest: Time) {
        self.news.postpone(by, latest);
    }

    /// Predicts over a time in which nothing was measured.
    pub(super) fn coast(&mut self, passed_s: f64) {
        self.before_m = None;
        self.state.altitude_m += self.state.climb_rate_mps * passed_s;
        self.covariance.coast(passed_s);
        if let Some(mark) = &mut self.mark {
            mark.predict(false, passed_s);
        }
    }

    /// Marks the present altitude.
    pub const fn mark(&mut self) {
        self.mark = Some(MarkedAltitude::new(self.state.altitude_m, &self.covariance));
    }

    /// The present estimate of the marked altitude, m.
    pub fn marked_altitude_m(&self) -> Option<f64> {
        self.mark.map(MarkedAltitude::altitude_m)
    }

    fn predict(&mut self, acceleration_mps2: f64, measured: bool, dt_s: f64) {
        let state = &mut self.state;
        state.altitude_m += state.climb_rate_mps * dt_s + 0.5 * acceleration_mps2 * dt_s * dt_s;
        state.climb_rate_mps += acceleration_mps2 * dt_s;
        self.covariance.predict(measured, dt_s);
        if let Some(mark) = &mut self.mark {
            mark.predict(measured, dt_s);
        }
    }

    /// Adopts an altitude. A mark is kept unchanged: later measurements carry
    /// no more information about it.
    fn begin(&mut self, altitude_m: f64) {
        self.before_m = None;
        self.state = VerticalState {
            altitude_m,
            climb_rate_mps: 0.0,
        };
        self.bias_mps2 = 0.0;
        self.covariance.restart();
        self.covariance.widen(self.resolution.step());
        if let Some(mark) = &mut self.mark {
            mark.keep();
        }
    }

    /// By a coarse altimeter that changed by `change_m`.
    fn correct_coarse(&mut self, altitude_m: f64, change_m: f64, since_s: f64) {
        let error_m = altitude_m - self.state.altitude_m;
        let beyond_m = self.resolution.beyond(error_m);
        if change_m == 0.0 {
            let gains = self
                .covariance
                .correct_by_step(self.resolution.step(), since_s);
            self.correct(beyond_m, &gains);
            return;
        }
        let edge_m = self.resolution.error_from_edge(error_m, change_m);
        let climb_rate_mps = self.state.climb_rate_mps;
        let gains = self.covariance.correct_by_edge(climb_rate_mps, since_s);
        self.correct(edge_m, &gains);
    }

    fn correct(&mut self, error: f64, gains: &Gains) {
        self.state.altitude_m += gains.altitude * error;
        self.state.climb_rate_mps += gains.climb_rate_per_s * error;
        self.bias_mps2 = limit_abs(self.bias_mps2 + gains.bias_per_s2 * error, MAX_BIAS_MPS2);
        if let Some(mark) = &mut self.mark {
            mark.correct(gains, error);
        }
    }
}

#[cfg(test)]
mod tests;
