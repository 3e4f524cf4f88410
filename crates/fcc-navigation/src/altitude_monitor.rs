//! Whether the altimeter is believed, and altitude and climb rate without it.

use super::altitude_input::AltitudeInput;
use super::coasting::{Coasting, DIFFERS_M};
use super::vertical::Reference;

/// The time for which a copy runs without the altimeter before it is compared,
/// s: so long that an aircraft climbs beyond the limit, so short that the error
/// of an accelerometer does not.
const ALONE_S: f64 = 8.0;
/// The filter knows the accelerometer's bias after this time, s: its bandwidth is
/// 0.1 rad/s.
const SETTLED_S: f64 = 18.0;
/// The altimeter is doubted if a copy contradicts it for this time, s, or a range finder
/// and the copy for that.
const DOUBTED_AFTER_S: f64 = 1.0;
const DOUBTED_BY_RANGE_AFTER_S: f64 = 0.3;
/// Without the altimeter the climb rate follows the path with this bandwidth,
/// the ground velocity with that one, rad/s: gusts have correlation times of up to 10 s
/// (MIL-F-8785C, 3.7.3).
const PATH_RADPS: f64 = 0.07;
const GROUND_RADPS: f64 = 1.0;
/// The error of the path's climb rate, m/s, and the share of vertical gusts that
/// stays in it; the altitude is sound up to this error, m (200 ft).
const PATH_ERROR_MPS: f64 = 0.4;
const GUST_SHARE: f64 = 0.3;
const SOUND_M: f64 = 60.0;
/// The altimeter is believed again when it has moved by this, m, and then agreed
/// for this time, s.
const MOVED_M: f64 = 8.0;
const BELIEVED_AFTER_S: f64 = 20.0;

/// What is known while the altimeter is doubted.
#[derive(Clone, Copy, Debug)]
struct Doubted {
    stood_m: f64,
    has_moved: bool,
    agrees_s: f64,
    error_m: f64,
}

/// Compares the altimeter with the accelerometers.
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

/// What is followed with a silent altimeter and without a receiver: level flight, which is
/// flown then. The path by pitch and lift is none: it learns from the climb rate.
pub(super) const LEVEL: Reference = Reference(0.0, PATH_RADPS);

/// What the filter has to do.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict {
    /// Follow the altimeter.
    Believed,
    /// Begin anew with this copy, without the altimeter.
    DoubtBegins(Coasting),
    /// Follow no altimeter.
    Doubted,
    /// Adopt the altimeter's altitude, m.
    BelievedAgain(f64),
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

    /// Begins anew with a copy, without the altimeter.
    fn doubt(&mut self, copy: Coasting, input: &AltitudeInput) -> Verdict {
        self.doubted = Some(Doubted {
            stood_m: input.altitude_m.unwrap_or(copy.state.altitude_m),
            has_moved: false,
            agrees_s: 0.0,
            error_m: copy.error_m,
        });
        Verdict::DoubtBegins(copy)
    }

    /// Processes one tick.
    pub(super) fn step(&mut self, input: &AltitudeInput, dt_s: f64) -> Verdict {
        if let Some(doubted) = &mut self.doubted {
            if input.ground_mps.is_none() {
                doubted.error_m += (PATH_ERROR_MPS + GUST_SHARE * input.gusts_mps) * dt_s;
            }
            let Some(altitude_m) = input.altitude_m else {
                return Verdict::Doubted;
            };
            doubted.has_moved |= (altitude_m - doubted.stood_m).abs() > MOVED_M + input.step_m;
            let by_m = (altitude_m - input.followed.altitude_m).abs();
            let agrees = doubted.has_moved && by_m < DIFFERS_M + input.step_m + doubted.error_m;
            doubted.agrees_s = if agrees { doubted.agrees_s + dt_s } else { 0.0 };
            if doubted.agrees_s > BELIEVED_AFTER_S {
                *self = Self::new();
                return Verdict::BelievedAgain(altitude_m);
            }
            return Verdict::Doubted;
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
                return self.doubt(older.by_ground(), input);
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
/// the ground, or the one by pitch and lift, m/s.
pub(super) fn reference(ground_mps: Option<f64>, path_mps: Option<f64>) -> Option<Reference> {
    let path = path_mps.map(|mps| Reference(mps, PATH_RADPS));
    let ground = ground_mps.map(|mps| Reference(mps, GROUND_RADPS));
    ground.or(path)
}
