//! A copy of the vertical filter that has run without the altimeter.

use super::altitude_input::AltitudeInput;
use super::vertical::VerticalState;

/// The altimeter differs by more than this, m, its step, and what the copy can be
/// wrong by.
pub(super) const DIFFERS_M: f64 = 12.0;
/// The copy's errors: of the climb rate when it was copied, m/s; of the
/// accelerometer, m/s², with the wings level and by tan φ: an error of the bank
/// by 1° is one of the vertical acceleration by 0.017 g tan φ.
const COPIED_MPS: f64 = 0.3;
const FELT_MPS2: f64 = 0.15;
const FELT_BANKED_MPS2: f64 = 0.5;
/// What the step of a coarse altimeter, m, adds to both: its filter knows climb rate and bias
/// the less, 1/s and 1/s².
const COPIED_PER_STEP: f64 = 0.03;
const FELT_PER_STEP: f64 = 0.006;
/// The share of a climb by which geometric and pressure altitude differ: the
/// air's temperature, 30 K off the standard (ISO 2533).
const TEMPERATURE_SHARE: f64 = 0.12;
/// In a gust beyond the loads of its models the path goes on as before, for this time, s.
const PATH_HELD_S: f64 = 2.0;
/// What must agree that the aircraft moves as the accelerometers say, by this
/// share: the path by pitch and lift, or the ground velocity.
const PATH_SHARE: f64 = 0.4;
const GROUND_SHARE: f64 = 0.5;
/// A range finder over ground that is about level tells sooner: the altimeter is doubted
/// if it differs from it by more than this, m, if the ground velocity agrees with the
/// range to this share of that, and the copy to the share above.
const RANGE_DIFFERS_M: f64 = 2.0;
const RANGE_SHARE: f64 = 0.35;

/// A copy of the filter that has run without the altimeter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coasting {
    pub(super) state: VerticalState,
    pub(super) bias_mps2: f64,
    began_m: f64,
    /// Climbed by the path, and by the ground velocity, m.
    path_m: Option<f64>,
    /// The latest climb rate by the path, m/s, and for how long there is none, s.
    path_mps: Option<f64>,
    no_path_s: f64,
    ground_m: Option<f64>,
    /// As they were with the first range.
    first: Option<Heights>,
    error_mps: f64,
    pub(super) error_m: f64,
    pub(super) lasted_s: f64,
}

/// Four measures of a climb, m, each above a height of its own.
#[derive(Clone, Copy, Debug)]
struct Heights {
    range_m: f64,
    altimeter_m: f64,
    copy_m: f64,
    ground_m: f64,
}

impl Coasting {
    pub(super) const fn of(input: &AltitudeInput) -> Self {
        Self {
            state: input.followed,
            bias_mps2: input.bias_mps2,
            began_m: input.followed.altitude_m,
            path_m: Some(0.0),
            path_mps: None,
            no_path_s: 0.0,
            ground_m: Some(0.0),
            first: None,
            error_mps: COPIED_MPS + COPIED_PER_STEP * input.step_m,
            error_m: 0.0,
            lasted_s: 0.0,
        }
    }

    pub(super) fn step(&mut self, input: &AltitudeInput, dt_s: f64) {
        self.state.climb_rate_mps += (input.felt_mps2 - self.bias_mps2) * dt_s;
        self.state.altitude_m += self.state.climb_rate_mps * dt_s;
        let add = |sum: Option<f64>, per_s: Option<f64>| Some(sum? + per_s? * dt_s);
        self.no_path_s = input.path_mps.map_or(self.no_path_s + dt_s, |_| 0.0);
        self.path_mps = input.path_mps.or(self.path_mps);
        let path_mps = self.path_mps.filter(|_| self.no_path_s < PATH_HELD_S);
        self.path_m = add(self.path_m, path_mps);
        self.ground_m = add(self.ground_m, input.ground_mps);
        let felt_mps2 =
            FELT_MPS2 + FELT_BANKED_MPS2 * input.tan_bank.abs() + FELT_PER_STEP * input.step_m;
        self.error_mps += felt_mps2 * dt_s;
        self.error_m += self.error_mps * dt_s;
        self.lasted_s += dt_s;
        if self.first.is_none() {
            self.first = self.heights(input.followed.altitude_m, input);
        }
    }

    /// None without a range or a ground velocity.
    fn heights(&self, altimeter_m: f64, input: &AltitudeInput) -> Option<Heights> {
        Some(Heights {
            range_m: input.range_m?,
            altimeter_m,
            copy_m: self.state.altitude_m,
            ground_m: self.ground_m?,
        })
    }

    /// Whether the range finder contradicts the altimeter, and copy and ground velocity
    /// agree with it.
    pub(super) fn contradicts_by_range(&self, altitude_m: f64, input: &AltitudeInput) -> bool {
        let (Some(was), Some(is)) = (self.first, self.heights(altitude_m, input)) else {
            return false;
        };
        let climbed_m = is.range_m - was.range_m;
        let off_m = (is.altimeter_m - was.altimeter_m - climbed_m).abs();
        let agrees = |by_m: f64, share: f64| (by_m - climbed_m).abs() < share * off_m;
        off_m > RANGE_DIFFERS_M + input.step_m
            && agrees(is.copy_m - was.copy_m, GROUND_SHARE)
            && agrees(is.ground_m - was.ground_m, RANGE_SHARE)
    }

    /// Whether the altimeter stands although the aircraft climbs or sinks, or
    /// moves although it does not.
    pub(super) fn contradicts(&self, altitude_m: f64, input: &AltitudeInput) -> bool {
        let limit_m = DIFFERS_M + input.step_m;
        let shown_m = altitude_m - self.began_m;
        let by_m = self.state.altitude_m - altitude_m;
        if let Some(ground_m) = self.ground_m {
            let beyond_m = ground_m - shown_m;
            let temperature_m = TEMPERATURE_SHARE * ground_m.abs();
            return beyond_m.abs() > limit_m + temperature_m
                && by_m * beyond_m.signum() > GROUND_SHARE * beyond_m.abs();
        }
        let agrees = |path_m: f64| (path_m - shown_m) * by_m.signum() > PATH_SHARE * by_m.abs();
        by_m.abs() > limit_m + self.error_m && self.path_m.is_some_and(agrees)
    }

    /// With the altitude by the ground velocity, if there is one.
    pub(super) fn by_ground(mut self) -> Self {
        if let Some(ground_m) = self.ground_m {
            self.state.altitude_m = self.began_m + ground_m;
        }
        self
    }
}
