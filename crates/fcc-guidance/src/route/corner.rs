//! The arcs of a turn at a waypoint.

use libm::{atan2, cos, sin, tan};
use nalgebra::Vector2;

use crate::path::turn::{Turn, smallest_circle_m, smallest_turn_m};
use crate::path::{Path, cross, right_of, unit};

/// A turn from one leg onto the next, in the plane of its waypoint.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Corner {
    /// From where along the first leg the first arc begins, m before the waypoint.
    pub(super) lead_m: f64,
    first: Arc,
    /// The arc back onto the next leg, of a fly-over.
    second: Option<Arc>,
}

/// A part of a circle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Arc {
    centre_m: Vector2<f64>,
    radius_m: f64,
    clockwise: bool,
    end_m: Vector2<f64>,
}

/// What a turn is planned with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Conditions {
    /// True airspeed, m/s.
    pub(super) airspeed_mps: f64,
    /// Where the air moves to, m/s.
    pub(super) wind_mps: Vector2<f64>,
    /// Bank, rad.
    pub(super) bank_rad: f64,
    /// The room that there is for a fly-by on both legs, m: where it does not fit, it
    /// is planned as sharp as it has to be.
    pub(super) room_m: f64,
    /// The waypoint is passed within this distance, m.
    pub(super) within_m: f64,
}

/// An arc ends no earlier before its end, and has ended so far behind it, rad: the
/// longest one, of 270°, begins at 90° behind its end.
const MOST_AHEAD_RAD: f64 = 1.0;
/// A smaller turn is none, rad.
const LEAST_RAD: f64 = 0.01;

impl Corner {
    /// The turn from one course onto another, both of length 1; none if they are
    /// almost the same.
    pub(super) fn new(from: Vector2<f64>, to: Vector2<f64>, with: &Conditions) -> Option<Self> {
        let through = atan2(cross(from, to), from.dot(&to));
        if through.abs() < LEAST_RAD {
            return None;
        }
        let sign = if through > 0.0 { 1.0 } else { -1.0 };
        let course = atan2(from.y, from.x);
        let radius = |from_rad: f64, through: f64| {
            let (airspeed, bank) = (with.airspeed_mps, with.bank_rad);
            smallest_turn_m(from_rad, through, airspeed, with.wind_mps, bank)
                .or_else(|| smallest_circle_m(airspeed, 0.0, bank))
                .unwrap_or(with.room_m)
        };
        let simple_m = radius(course, through);
        match Turn::within(through, simple_m, with.within_m) {
            Turn::FlyBy { lead_m } => {
                let lead_m = lead_m.min(with.room_m);
                Some(Self::by(from, to, lead_m, through))
            }
            Turn::FlyOver { beyond_rad, .. } => {
                let (far, back) = (through + sign * beyond_rad, -sign * beyond_rad);
                let radius_m = radius(course, far).max(radius(course + far, back));
                Some(Self::over(from, to, radius_m, sign * beyond_rad))
            }
        }
    }

    fn by(from: Vector2<f64>, to: Vector2<f64>, lead_m: f64, through: f64) -> Self {
        let radius_m = lead_m / tan(0.5 * through.abs());
        let side = right_of(from) * if through > 0.0 { radius_m } else { -radius_m };
        Self {
            lead_m,
            first: Arc {
                centre_m: side - from * lead_m,
                radius_m,
                clockwise: through > 0.0,
                end_m: to * lead_m,
            },
            second: None,
        }
    }

    /// `beyond_rad` has the sign of the turn.
    fn over(from: Vector2<f64>, to: Vector2<f64>, radius_m: f64, beyond_rad: f64) -> Self {
        let clockwise = beyond_rad > 0.0;
        let signed_m = if clockwise { radius_m } else { -radius_m };
        let between = turned(to, beyond_rad);
        let centre_m = right_of(from) * signed_m;
        let end_m = centre_m - right_of(between) * signed_m;
        let back_m = end_m - right_of(between) * signed_m;
        Self {
            lead_m: 0.0,
            first: Arc {
                centre_m,
                radius_m,
                clockwise,
                end_m,
            },
            second: Some(Arc {
                centre_m: back_m,
                radius_m,
                clockwise: !clockwise,
                end_m: back_m + right_of(to) * signed_m,
            }),
        }
    }

    /// The arc that is flown first.
    pub(super) const fn first(&self) -> &Arc {
        &self.first
    }

    /// The arc back.
    pub(super) const fn second(&self) -> Option<&Arc> {
        self.second.as_ref()
    }
}

impl Arc {
    pub(super) const fn path(&self) -> Path {
        Path::Circle {
            centre_m: self.centre_m,
            radius_m: self.radius_m,
            clockwise: self.clockwise,
        }
    }

    /// Whether its end is at most so far ahead, m, or not far behind, as seen from its
    /// centre: an aircraft that cannot turn so sharply comes to an end, too.
    pub(super) fn ends_within(&self, ahead_m: f64, position_m: Vector2<f64>) -> bool {
        let (at, end) = (position_m - self.centre_m, self.end_m - self.centre_m);
        let right_rad = atan2(cross(at, end), at.dot(&end));
        let left_to_turn = if self.clockwise {
            right_rad
        } else {
            -right_rad
        };
        let ahead_rad = (ahead_m / self.radius_m).min(MOST_AHEAD_RAD);
        (-MOST_AHEAD_RAD..=ahead_rad).contains(&left_to_turn)
    }
}

/// A vector of length 1 turned right by an angle.
pub(super) fn turned(v: Vector2<f64>, by_rad: f64) -> Vector2<f64> {
    unit(v * cos(by_rad) + right_of(v) * sin(by_rad)).unwrap_or(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn calm(within_m: f64) -> Conditions {
        Conditions {
            airspeed_mps: 50.0,
            wind_mps: Vector2::zeros(),
            bank_rad: 0.5,
            room_m: 1e4,
            within_m,
        }
    }

    /// Both arcs of a fly-over touch: the second begins where and as the first ends,
    /// and ends on the next leg at the distance that the validator uses.
    #[test]
    fn a_fly_over_ends_on_the_next_leg() {
        let from = Vector2::new(1.0, 0.0);
        for (through_deg, within_m) in [
            (100.0_f64, f64::INFINITY),
            (120.0, f64::INFINITY),
            (150.0, f64::INFINITY),
            (179.0, f64::INFINITY),
            (-100.0, f64::INFINITY),
            (-150.0, f64::INFINITY),
            (60.0, 1.0),
            (-60.0, 1.0),
        ] {
            let through = through_deg.to_radians();
            let to = turned(from, through);
            let corner = Corner::new(from, to, &calm(within_m)).unwrap();
            let second = corner.second.unwrap();
            assert!(cross(to, second.end_m).abs() < 1e-6, "{corner:?}");
            let Turn::FlyOver { rejoin_m, .. } = Turn::within(through, second.radius_m, within_m)
            else {
                panic!("{through_deg}");
            };
            assert!((to.dot(&second.end_m) - rejoin_m).abs() < 1e-6);
            let begin = corner.first.end_m - second.centre_m;
            assert!((begin.norm() - second.radius_m).abs() < 1e-6);
            let [at_end, at_begin] =
                [&corner.first, &second].map(|arc| arc.path().nearest(corner.first.end_m).course);
            assert!((at_begin - at_end).norm() < 1e-9);
            assert!(!corner.first.ends_within(50.0, Vector2::zeros()));
            assert!(corner.first.ends_within(50.0, corner.first.end_m));
        }
    }

    /// A fly-by touches both legs: R = V²/(g tan φ), 466.6 m at 50 m/s and 0.5 rad.
    #[test]
    fn a_fly_by_touches_both_legs() {
        let from = Vector2::new(1.0, 0.0);
        for through in [1.5_f64, 0.5, -0.5, -1.5] {
            let to = turned(from, through);
            let corner = Corner::new(from, to, &calm(f64::INFINITY)).unwrap();
            let radius_m = 50.0 * 50.0 / (9.806_65 * 0.5_f64.tan());
            assert!((corner.lead_m - radius_m * (through.abs() / 2.0).tan()).abs() < 1e-6);
            let path = corner.first().path();
            for (point, course) in [(-from * corner.lead_m, from), (to * corner.lead_m, to)] {
                let nearest = path.nearest(point);
                assert!(nearest.cross_track_m.abs() < 1e-6);
                assert!((nearest.course - course).norm() < 1e-9);
            }
        }
    }
}
