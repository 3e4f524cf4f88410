//! How the magnetic field turns in body axes, beside how the gyroscopes say that
//! it does.
//!
//! The earth's field stands still, so in body axes it turns against the aircraft:
//! dm/dt = m × ω (Titterton and Weston 2004, section 2.4: the rate of change of a
//! vector in a turning frame). That shows two of the three rates, those across
//! the field.

use nalgebra::{UnitQuaternion, Vector3};

use super::kalman::{GAP_S, turn};
use fcc_core::framework::Time;

/// Samples of the field are fitted over this time at least, s: long enough for
/// the noise of a phone's compass (1 % of the field) to be 1°.
const WINDOW_S: f64 = 0.2;
/// And over so many samples at least; slower magnetometers have longer windows,
/// up to this one, s.
const LEAST_SAMPLES: f64 = 6.0;
const LONGEST_WINDOW_S: f64 = 1.0;

/// Half a second of gyroscopes at 128 Hz; a magnetometer's sample comes some
/// 10 ms later than one of them.
const KEPT: usize = 64;

/// How the field turned over a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turning {
    /// The rotation of the aircraft that the field shows, across itself, body
    /// axes, rad.
    pub(super) shown: Vector3<f64>,
    /// What the gyroscopes have turned less that, across the field, rad.
    pub(super) error: Vector3<f64>,
    /// How far the gyroscopes have turned in all, along the field as well, rad.
    pub(super) turned_rad: f64,
    /// The variance of each part of both, by the scatter of the samples, rad².
    pub(super) variance: f64,
    /// The strength of the field, µT, and the scatter of its samples, as a share of
    /// that.
    pub(super) strength_ut: f64,
    pub(super) scatter: f64,
}

impl Turning {
    pub(super) const NONE: Self = Self {
        shown: Vector3::new(0.0, 0.0, 0.0),
        error: Vector3::new(0.0, 0.0, 0.0),
        turned_rad: 0.0,
        variance: 0.0,
        strength_ut: 0.0,
        scatter: 0.0,
    };
}

/// Orientation by the integrated rates, at the time of a sample.
#[derive(Clone, Copy, Debug)]
struct Oriented {
    taken: Time,
    attitude: UnitQuaternion<f64>,
    /// The rates that led here.
    rates: Vector3<f64>,
}

/// Sums of the samples of a window, for a straight line through each axis.
#[derive(Clone, Copy, Debug)]
struct Window {
    began: Time,
    /// From body axes at its beginning to those of the integral.
    attitude: UnitQuaternion<f64>,
    /// The aircraft's own field, as known at its beginning: what is learned of it turns
    /// nothing.
    own: Vector3<f64>,
    samples: f64,
    time: f64,
    time_squared: f64,
    /// The field in body axes, and turned back by the gyroscopes.
    body: Line,
    steady: Line,
}

#[derive(Clone, Copy, Debug, Default)]
struct Line {
    sum: Vector3<f64>,
    by_time: Vector3<f64>,
    squared: f64,
}

impl Line {
    fn add(&mut self, time_s: f64, value: Vector3<f64>) {
        self.sum += value;
        self.by_time += value * time_s;
        self.squared += value.norm_squared();
    }
}

/// Compares how the field turns with the integrated gyroscopes.
#[derive(Clone, Debug)]
pub(super) struct FieldTurning {
    oriented: [Oriented; KEPT],
    latest: usize,
    window: Option<Window>,
    last: Vector3<f64>,
    field_taken: Time,
}

impl FieldTurning {
    pub(super) fn new() -> Self {
        let none = Oriented {
            taken: Time::NEVER,
            attitude: UnitQuaternion::identity(),
            rates: Vector3::zeros(),
        };
        Self {
            oriented: [none; KEPT],
            latest: 0,
            window: None,
            last: Vector3::zeros(),
            field_taken: Time::NEVER,
        }
    }

    /// Takes a sample of the gyroscopes without their bias, rad/s.
    pub(super) fn add_rates(&mut self, taken: Time, rates: Vector3<f64>) {
        let Some(before) = self.oriented.get(self.latest).copied() else {
            return;
        };
        let dt_s = taken.since(before.taken).as_secs_f64();
        let attitude = if before.taken.is_never() || dt_s > GAP_S {
            *self = Self::new();
            UnitQuaternion::identity()
        } else {
            let mut attitude = before.attitude * turn(rates * dt_s);
            attitude.renormalize_fast();
            attitude
        };
        self.latest = (self.latest + 1) % KEPT;
        if let Some(oriented) = self.oriented.get_mut(self.latest) {
            *oriented = Oriented {
                taken,
                attitude,
                rates,
            };
        }
    }

    /// Takes a sample of the field, and the aircraft's own, µT; how the field turned, if
    /// that ends a window. What is repeated to the last bit says nothing.
    pub(super) fn add_field(
        &mut self,
        taken: Time,
        field: Vector3<f64>,
        own: Vector3<f64>,
    ) -> Option<Turning> {
        if field == self.last || taken <= self.field_taken {
            return None;
        }
        self.last = field;
        self.field_taken = taken;
        let Some(attitude) = self.attitude_at(taken) else {
            self.window = None;
            return None;
        };
        let mut ended = None;
        if let Some(mut window) = self.window {
            let lasted_s = taken.since(window.began).as_secs_f64();
            let is_full = lasted_s >= WINDOW_S && window.samples >= LEAST_SAMPLES;
            if is_full {
                // Its last sample is the first of the next: a jump is inside of one.
                window.add(taken, field, attitude);
                ended = window.turning(lasted_s, attitude);
            }
            if is_full || lasted_s > LONGEST_WINDOW_S {
                self.window = None;
            }
        }
        let window = self.window.get_or_insert(Window {
            began: taken,
            attitude,
            own,
            samples: 0.0,
            time: 0.0,
            time_squared: 0.0,
            body: Line::default(),
            steady: Line::default(),
        });
        window.add(taken, field, attitude);
        ended
    }

    /// From body axes at a time to those of the integral.
    fn attitude_at(&self, time: Time) -> Option<UnitQuaternion<f64>> {
        let mut rates = None;
        for back in 0..KEPT {
            let oriented = self.oriented.get((self.latest + KEPT - back) % KEPT)?;
            if oriented.taken.is_never() {
                return None;
            }
            if oriented.taken <= time {
                let dt_s = time.since(oriented.taken).as_secs_f64();
                let turned = turn(rates.unwrap_or(oriented.rates) * dt_s);
                return (dt_s <= GAP_S).then(|| oriented.attitude * turned);
            }
            rates = Some(oriented.rates);
        }
        None
    }
}

impl Window {
    fn add(&mut self, taken: Time, field: Vector3<f64>, attitude: UnitQuaternion<f64>) {
        let body = field - self.own;
        let time_s = taken.since(self.began).as_secs_f64();
        self.samples += 1.0;
        self.time += time_s;
        self.time_squared += time_s * time_s;
        self.body.add(time_s, body);
        self.steady.add(time_s, attitude * body);
    }

    /// The rotations over `lasted_s` by the slopes of the lines, ω = (dm/dt × m) / m²,
    /// and their variance by what is left of the samples beside them.
    fn turning(&self, lasted_s: f64, attitude: UnitQuaternion<f64>) -> Option<Turning> {
        let n = self.samples;
        let spread = self.time_squared - self.time * self.time / n;
        let slope = |line: &Line| (line.by_time - line.sum * (self.time / n)) / spread;
        let back = self.attitude.inverse();
        let (body, steady) = (self.body.sum / n, back * (self.steady.sum / n));
        let (by_field, by_error) = (slope(&self.body), back * slope(&self.steady));
        let strength_squared = body.norm_squared();
        if spread <= 0.0 || strength_squared <= 0.0 {
            return None;
        }
        // A rate that is very wrong bends the one, a fast turn the other.
        let left = |line: &Line, slope: Vector3<f64>| {
            let scattered = line.squared - line.sum.norm_squared() / n;
            (scattered - slope.norm_squared() * spread).max(0.0)
        };
        let left = left(&self.steady, by_error).min(left(&self.body, by_field));
        // Two parameters of each of three axes are fitted.
        let sample_variance = left / (3.0 * (n - 2.0));
        let per_slope = lasted_s / strength_squared;
        Some(Turning {
            shown: by_field.cross(&body) * per_slope,
            error: steady.cross(&by_error) * per_slope,
            turned_rad: self.attitude.angle_to(&attitude),
            variance: sample_variance / spread * lasted_s * lasted_s / strength_squared,
            strength_ut: libm::sqrt(strength_squared),
            scatter: libm::sqrt(left / (3.0 * n) / strength_squared),
        })
    }
}
