//! Whether the altimeter is believed, and altitude and climb rate without it.

use super::airspeed_monitor::Blocked;
use super::scalar_update::squared;
use super::vertical::{Reference, VerticalState};
use crate::units::GRAVITY_MPS2;

/// The time for which a copy runs without the altimeter before it is compared,
/// s: so long that an aircraft climbs beyond the limit, so short that the error
/// of an accelerometer does not.
const ALONE_S: f64 = 8.0;
/// The filter knows the accelerometer's bias after this time, s: its bandwidth is
/// 0.1 rad/s.
const SETTLED_S: f64 = 18.0;
/// The altimeter is doubted if it differs for this time, s, by more than this,
/// m, its step, and what the copy can be wrong by.
const DOUBTED_AFTER_S: f64 = 1.0;
const DIFFERS_M: f64 = 12.0;
/// The copy's errors: of the climb rate when it was copied, m/s; of the
/// accelerometer, m/s², with the wings level and by tan φ: an error of the bank
/// by 1° is one of the vertical acceleration by 0.017 g tan φ.
const COPIED_MPS: f64 = 0.3;
const FELT_MPS2: f64 = 0.04;
const FELT_BANKED_MPS2: f64 = 0.17;
/// The share of a climb by which geometric and pressure altitude differ: the
/// air's temperature, 30 K off the standard (ISO 2533).
const TEMPERATURE_SHARE: f64 = 0.12;
/// What must agree that the aircraft moves as the accelerometers say, by this
/// share: the path by pitch and lift, the ground velocity, or an airspeed that
/// differs as one does whose static pressure is trapped.
const PATH_SHARE: f64 = 0.4;
const GROUND_SHARE: f64 = 0.5;
const TRAPPED: core::ops::RangeInclusive<f64> = 0.5..=2.0;
/// A range finder over ground that is about level tells sooner: the altimeter is doubted
/// if it differs from it by more than this, m, for this time, s, if the ground velocity
/// agrees with the range to this share of that, and the copy to the share above.
const RANGE_DIFFERS_M: f64 = 2.0;
const DOUBTED_BY_RANGE_AFTER_S: f64 = 0.3;
const RANGE_SHARE: f64 = 0.35;
/// Without the altimeter the climb rate follows the path with this bandwidth,
/// the ground velocity with that one, and the altitude that by the total pressure,
/// rad/s: gusts have correlation times of up to 10 s (MIL-F-8785C, 3.7.3).
const PATH_RADPS: f64 = 0.07;
const GROUND_RADPS: f64 = 1.0;
const TOTAL_RADPS: f64 = 0.15;
/// The total pressure is not known from a lower airspeed, m/s: it ends at 0.
pub(super) const LEAST_MPS: f64 = 13.0;
/// The error of the path's climb rate, m/s, and the share of vertical gusts that
/// stays in it; the altitude is sound up to this error, m (200 ft).
const PATH_ERROR_MPS: f64 = 0.4;
const GUST_SHARE: f64 = 0.3;
const SOUND_M: f64 = 60.0;
/// The altimeter is believed again when it has moved by this, m, and then agreed
/// for this time, s.
const MOVED_M: f64 = 8.0;
const BELIEVED_AFTER_S: f64 = 20.0;

/// One tick's inputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct AltitudeInput {
    /// The altimeter's, m, if it is current, and the step of a coarse one.
    pub(super) altitude_m: Option<f64>,
    pub(super) step_m: f64,
    /// It has just stepped, and the filter has adopted its altitude.
    pub(super) has_stepped: bool,
    /// The filter's state with the altimeter, and its bias, m/s².
    pub(super) followed: VerticalState,
    pub(super) bias_mps2: f64,
    /// The vertical acceleration with the bias, up, m/s².
    pub(super) felt_mps2: f64,
    /// Climb rates by pitch and lift, and over the ground, m/s.
    pub(super) path_mps: Option<f64>,
    pub(super) ground_mps: Option<f64>,
    /// The range finder's height above the ground, m.
    pub(super) range_m: Option<f64>,
    pub(super) tan_bank: f64,
    pub(super) gusts_mps: f64,
    /// Indicated airspeed by the sensor and as estimated, m/s, and the felt
    /// acceleration along the path, m/s².
    pub(super) sensor_mps: Option<f64>,
    pub(super) airspeed_mps: f64,
    pub(super) accelerates_mps2: f64,
    /// Of the air, over that at sea level.
    pub(super) density_ratio: f64,
    /// The altitude by the total pressure is known.
    pub(super) has_total: bool,
    /// A doubted airspeed tells that the static port is blocked.
    pub(super) blocked: Option<Blocked>,
    /// Whether the altimeter may be doubted: while engaged.
    pub(super) may_doubt: bool,
}

/// A copy of the filter that has run without the altimeter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coasting {
    pub(super) state: VerticalState,
    pub(super) bias_mps2: f64,
    /// Indicated airspeed by the accelerometers alone, m/s.
    pub(super) airspeed_mps: f64,
    began_m: f64,
    /// Climbed by the path, and by the ground velocity, m.
    path_m: Option<f64>,
    ground_m: Option<f64>,
    /// As they were with the first range.
    first: Option<Heights>,
    error_mps: f64,
    error_m: f64,
    lasted_s: f64,
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
    const fn of(input: &AltitudeInput) -> Self {
        Self {
            state: input.followed,
            bias_mps2: input.bias_mps2,
            airspeed_mps: input.airspeed_mps,
            began_m: input.followed.altitude_m,
            path_m: Some(0.0),
            ground_m: Some(0.0),
            first: None,
            error_mps: COPIED_MPS,
            error_m: 0.0,
            lasted_s: 0.0,
        }
    }

    fn step(&mut self, input: &AltitudeInput, dt_s: f64) {
        self.state.climb_rate_mps += (input.felt_mps2 - self.bias_mps2) * dt_s;
        self.state.altitude_m += self.state.climb_rate_mps * dt_s;
        self.airspeed_mps += input.accelerates_mps2 * dt_s;
        let add = |sum: Option<f64>, per_s: Option<f64>| Some(sum? + per_s? * dt_s);
        self.path_m = add(self.path_m, input.path_mps);
        self.ground_m = add(self.ground_m, input.ground_mps);
        self.error_mps += (FELT_MPS2 + FELT_BANKED_MPS2 * input.tan_bank.abs()) * dt_s;
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
    fn contradicts_by_range(&self, altitude_m: f64, input: &AltitudeInput) -> bool {
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
    fn contradicts(&self, altitude_m: f64, input: &AltitudeInput) -> bool {
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
        by_m.abs() > limit_m + self.error_m
            && (self.path_m.is_some_and(agrees) || self.is_trapped(by_m, input))
    }

    /// Whether the airspeed differs as one does whose static pressure is that of
    /// an altitude `by_m` lower: ½ ρ₀ (V² - V'²) = ρ g h (FAA-H-8083-15B,
    /// chapter 5, blocked static system).
    fn is_trapped(&self, by_m: f64, input: &AltitudeInput) -> bool {
        input.sensor_mps.is_some_and(|sensor_mps| {
            let density = input.density_ratio;
            let height_m = height_by_total_pressure_m(sensor_mps, self.airspeed_mps, density);
            TRAPPED.contains(&(height_m / by_m))
        })
    }

    /// The right airspeed, m/s: the sensor's, or that corrected for a trapped
    /// static pressure, whichever is nearer to the accelerometers'; and whether it
    /// is the latter, so that the sensor shares the port.
    pub(super) fn right_airspeed(
        &self,
        altitude_m: f64,
        sensor_mps: f64,
        density: f64,
    ) -> (f64, bool) {
        let height_m = self.state.altitude_m - altitude_m;
        let squared_mps2 = squared(sensor_mps) + 2.0 * density * GRAVITY_MPS2 * height_m;
        let corrected_mps = libm::sqrt(squared_mps2.max(0.0));
        let by = |mps: f64| (mps - self.airspeed_mps).abs();
        if by(corrected_mps) < by(sensor_mps) {
            (corrected_mps, true)
        } else {
            (sensor_mps, false)
        }
    }
}

/// What is known while the altimeter is doubted.
#[derive(Clone, Copy, Debug)]
struct Doubted {
    stood_m: f64,
    has_moved: bool,
    agrees_s: f64,
    error_m: f64,
    /// Only a blocked static port explains the airspeed.
    by_airspeed: bool,
}

/// Holds the altimeter against the accelerometers.
///
/// Copies of the vertical filter have run without the altimeter for 8 s and
/// more. What they feel does not depend on the wind: air that rises or sinks
/// moves the altimeter and the accelerometers alike. A second quantity must
/// agree, so that a fault of the accelerometers is none of the altimeter.
#[derive(Clone, Debug)]
pub(super) struct AltitudeMonitor {
    older: Option<Coasting>,
    younger: Option<Coasting>,
    /// Time with an altimeter, s.
    followed_s: f64,
    beyond_s: f64,
    beyond_range_s: f64,
    doubted: Option<Doubted>,
}

/// What the filter has to do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict {
    /// Follow the altimeter.
    Believed,
    /// Begin anew with this copy, without the altimeter.
    DoubtBegins(Coasting),
    /// The same with this state, because the static port is blocked.
    StaticPortIsBlocked(VerticalState),
    /// Follow no altimeter.
    Doubted,
    /// Adopt the altimeter's altitude, m.
    BelievedAgain(f64),
    /// The same, because the altimeter moves: its port is not blocked.
    StaticPortIsFree(f64),
}

impl AltitudeMonitor {
    pub(super) const fn new() -> Self {
        Self {
            older: None,
            younger: None,
            followed_s: 0.0,
            beyond_s: 0.0,
            beyond_range_s: 0.0,
            doubted: None,
        }
    }

    pub(super) const fn is_doubted(&self) -> bool {
        self.doubted.is_some()
    }

    /// Whether the altitude without the altimeter is still known.
    pub(super) fn is_sound(&self) -> bool {
        self.doubted.is_none_or(|doubted| doubted.error_m < SOUND_M)
    }

    /// Processes one tick.
    pub(super) fn step(&mut self, input: &AltitudeInput, dt_s: f64) -> Verdict {
        if let Some(doubted) = &mut self.doubted {
            if input.ground_mps.is_none() && !input.has_total {
                doubted.error_m += (PATH_ERROR_MPS + GUST_SHARE * input.gusts_mps) * dt_s;
            }
            let Some(altitude_m) = input.altitude_m else {
                return Verdict::Doubted;
            };
            doubted.has_moved |= (altitude_m - doubted.stood_m).abs() > MOVED_M + input.step_m;
            if doubted.has_moved && doubted.by_airspeed {
                *self = Self::new();
                return Verdict::StaticPortIsFree(altitude_m);
            }
            let by_m = (altitude_m - input.followed.altitude_m).abs();
            let agrees = doubted.has_moved && by_m < DIFFERS_M + input.step_m + doubted.error_m;
            doubted.agrees_s = if agrees { doubted.agrees_s + dt_s } else { 0.0 };
            if doubted.agrees_s > BELIEVED_AFTER_S {
                *self = Self::new();
                return Verdict::BelievedAgain(altitude_m);
            }
            return Verdict::Doubted;
        }
        if let (true, Some(blocked), Some(altitude_m)) =
            (input.may_doubt, input.blocked, input.altitude_m)
        {
            self.doubted = Some(Doubted {
                stood_m: altitude_m,
                has_moved: false,
                agrees_s: 0.0,
                error_m: DIFFERS_M,
                by_airspeed: true,
            });
            return Verdict::StaticPortIsBlocked(VerticalState {
                altitude_m: altitude_m + blocked.height_m,
                climb_rate_mps: blocked.climb_rate_mps,
            });
        }
        if input.has_stepped {
            (self.older, self.younger) = (None, None);
        }
        let (Some(altitude_m), Some(mut older), Some(mut younger)) =
            (input.altitude_m, self.older, self.younger)
        else {
            let followed_s = self.followed_s + dt_s;
            self.followed_s = input.altitude_m.map_or(0.0, |_| followed_s);
            let copy = (self.followed_s > SETTLED_S).then(|| Coasting::of(input));
            (self.older, self.younger) = (copy, copy);
            return Verdict::Believed;
        };
        older.step(input, dt_s);
        younger.step(input, dt_s);
        let lasts = |beyond_s: f64, is_beyond: bool| if is_beyond { beyond_s + dt_s } else { 0.0 };
        let contradicts = older.lasted_s > ALONE_S && older.contradicts(altitude_m, input);
        self.beyond_s = lasts(self.beyond_s, contradicts);
        let contradicts = older.contradicts_by_range(altitude_m, input);
        self.beyond_range_s = lasts(self.beyond_range_s, contradicts);
        if self.beyond_s > DOUBTED_AFTER_S || self.beyond_range_s > DOUBTED_BY_RANGE_AFTER_S {
            (self.beyond_s, self.beyond_range_s) = (0.0, 0.0);
            if input.may_doubt {
                if let Some(ground_m) = older.ground_m {
                    older.state.altitude_m = older.began_m + ground_m;
                }
                self.doubted = Some(Doubted {
                    stood_m: altitude_m,
                    has_moved: false,
                    agrees_s: 0.0,
                    error_m: older.error_m,
                    by_airspeed: false,
                });
                return Verdict::DoubtBegins(older);
            }
            (self.older, self.younger) = (None, None);
            return Verdict::Believed;
        }
        let by_m = (older.state.altitude_m - altitude_m).abs();
        if younger.lasted_s > ALONE_S && by_m < 0.5 * (DIFFERS_M + input.step_m) + older.error_m {
            older = younger;
            younger = Coasting::of(input);
        }
        (self.older, self.younger) = (Some(older), Some(younger));
        Verdict::Believed
    }
}

/// What altitude and climb rate follow without an altimeter: the climb rate over
/// the ground, the altitude by the total pressure, or the climb rate by pitch and
/// lift, in m and m/s.
pub(super) fn reference(
    ground_mps: Option<f64>,
    by_total_m: Option<f64>,
    path_mps: Option<f64>,
) -> Option<Reference> {
    let path = || path_mps.map(|mps| Reference::ClimbRate(mps, PATH_RADPS));
    let total = || by_total_m.map(|m| Reference::Altitude(m, TOTAL_RADPS));
    let ground = ground_mps.map(|mps| Reference::ClimbRate(mps, GROUND_RADPS));
    ground.or_else(total).or_else(path)
}

/// The height above the altitude at which the static pressure is trapped, m, by
/// an airspeed sensor at the same port and the airspeed by forces and motion,
/// indicated, m/s: the tube still tells the total pressure, so that
/// h = ½ ρ₀ (V² - V'²) / (ρ g).
pub(super) fn height_by_total_pressure_m(sensor_mps: f64, forces_mps: f64, density: f64) -> f64 {
    0.5 * (squared(forces_mps) - squared(sensor_mps)) / (density * GRAVITY_MPS2)
}
