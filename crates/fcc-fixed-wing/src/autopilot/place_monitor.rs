//! Whether a measured position moves as the aircraft does.
//!
//! For positions of a receiver or a simulator that no navigation by raw readings judges.
//! A place that is repeated to the last bit for seconds is not that of an aircraft that
//! moves over the ground; where the velocity over the ground is repeated, too, or missing,
//! of one that has the airspeed of flight. A place that jumps, or moves otherwise than
//! the velocity over the ground as well as airspeed and heading say, is not used
//! either: what contradicts the velocity alone may be right.

use libm::hypot;
use nalgebra::Vector2;

use fcc_core::flight::earth::metres_per_radian;
use fcc_core::flight::{Position, Velocity};
use fcc_core::framework::{Reading, Time};

/// For so long a place or a velocity may be repeated, s: longer than a receiver that
/// gives one fix a second, and is read more often, repeats it.
const REPEATS_S: f64 = 3.0;
/// Slower than this it stands, m/s.
pub(super) const STANDS_MPS: f64 = 2.0;
/// So fast over the ground a place changes, m/s, also where its last digit is a metre.
const MOVES_MPS: f64 = 5.0;
/// Places are compared over so long, s.
const WINDOW_S: f64 = 4.0;
/// What a place may be off: so late, s, and by so much, m; beyond the latter of one that
/// jumps.
const LATE_S: f64 = 1.25;
const OFF_M: f64 = 30.0;
const JUMP_M: f64 = 100.0;
/// A place that moves as airspeed and heading say, but for a wind of so much, m/s, is
/// right, and the velocity wrong: the wind that was learned comes from that velocity.
const MOST_WIND_MPS: f64 = 15.0;
/// How often airspeed and heading are looked at, s.
const AIR_EVERY_S: f64 = 0.5;
/// It is used again after so many times of [`WINDOW_S`] in which it moved as the aircraft.
const GOOD_WINDOWS: u8 = 2;

/// Geodetic latitude and longitude, rad.
type Place = [f64; 2];

/// Why a position is not used.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum PlaceDoubt {
    /// It is only repeated.
    Repeats,
    /// It moves otherwise than the aircraft.
    Moves,
    /// It jumps.
    Jumps,
}

/// What is done with a position.
#[derive(Clone, Copy, Debug)]
pub(super) enum Verdict {
    Use,
    Leave,
    /// It is left from now on: the aircraft has moved so far, m, from this place.
    LeaveSince(Place, Vector2<f64>),
}

/// The way since a place.
#[derive(Clone, Copy, Debug, Default)]
struct Way {
    from: Place,
    passed_s: f64,
    /// By the velocity over the ground, or without one by air and wind, m.
    by_ground_m: Vector2<f64>,
}

/// What is known of the aircraft's motion besides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moving {
    pub(super) on_wheels: bool,
    pub(super) airspeed_mps: f64,
    pub(super) ground_mps: f64,
    /// How far the place is from where it was expected, m; none if it was not.
    pub(super) off_m: Option<f64>,
}

/// Follows the positions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaceMonitor {
    /// From this airspeed on it flies, m/s; none where positions are judged elsewhere.
    flies_mps: Option<f64>,
    seen: Time,
    /// Since the place became what it is.
    repeated: Way,
    /// Since the comparison began.
    window: Way,
    /// Of the comparison, by airspeed and heading, m, and for how long it is not added, s.
    by_air_m: Vector2<f64>,
    air_s: f64,
    velocity: [f64; 2],
    /// Since the velocity became what it is, s.
    velocity_s: f64,
    good_windows: u8,
    doubt: Option<PlaceDoubt>,
}

impl PlaceMonitor {
    /// For an aircraft that flies from this airspeed on, m/s.
    pub(super) fn new(flies_mps: f64) -> Self {
        Self {
            flies_mps: Some(flies_mps),
            ..Self::default()
        }
    }

    /// Before the first position.
    pub(super) fn anew(&self) -> Self {
        Self {
            flies_mps: self.flies_mps,
            ..Self::default()
        }
    }

    pub(super) const fn doubt(&self) -> Option<PlaceDoubt> {
        self.doubt
    }

    /// Whether a velocity is not used: it comes with a place that is not, and is repeated.
    pub(super) fn doubts_velocity(&self) -> bool {
        self.doubt.is_some() && self.velocity_s > REPEATS_S
    }

    /// Whether the velocity is another one since the last tick; always where positions are
    /// judged elsewhere.
    pub(super) fn has_new_velocity(&self) -> bool {
        self.velocity_s <= 0.0
    }

    /// Follows a velocity over the ground.
    pub(super) fn take_velocity(&mut self, velocity: &Reading<Velocity>) {
        let now = [velocity.value.north_mps, velocity.value.east_mps];
        if !velocity.is_never() && now != self.velocity {
            self.velocity = now;
            self.velocity_s = 0.0;
        }
    }

    /// The aircraft moves for a time, s, with this velocity over the ground, m/s; `air`
    /// says with which through the air.
    pub(super) fn advance(
        &mut self,
        ground_mps: Vector2<f64>,
        air: impl FnOnce() -> Vector2<f64>,
        dt_s: f64,
    ) {
        if self.flies_mps.is_none() {
            return;
        }
        for way in [&mut self.repeated, &mut self.window] {
            way.passed_s += dt_s;
            way.by_ground_m += ground_mps * dt_s;
        }
        self.velocity_s += dt_s;
        self.air_s += dt_s;
        if self.air_s >= AIR_EVERY_S {
            self.by_air_m += air() * self.air_s;
            self.air_s = 0.0;
        }
    }

    /// Judges a position that is new.
    pub(super) fn judge(&mut self, position: &Reading<Position>, moving: &Moving) -> Verdict {
        let Some(flies_mps) = self.flies_mps else {
            return Verdict::Use;
        };
        let place = [position.value.latitude_rad, position.value.longitude_rad];
        if position.taken <= self.seen {
            return self.verdict();
        }
        let is_first = self.seen.is_never();
        self.seen = position.taken;
        if place != self.repeated.from {
            self.repeated = Way::since(place);
        }
        // In motion a doubt from the flight lasts.
        let rolls = moving.on_wheels && (self.doubt.is_none() || moving.ground_mps < STANDS_MPS);
        if rolls || is_first || moving.off_m.is_none() && self.doubt.is_none() {
            self.doubt = None;
            self.begin_window(place);
            return Verdict::Use;
        }
        if self.doubt.is_some() && self.repeated.passed_s > REPEATS_S {
            // Perhaps too slow to tell, but the same still.
            self.good_windows = 0;
            self.begin_window(place);
            return self.verdict();
        }
        if self.repeats_in_motion(flies_mps, moving) {
            let since = self.repeated;
            return self.leave(PlaceDoubt::Repeats, Some(since), place);
        }
        let jumps = moving
            .off_m
            .is_some_and(|off_m| off_m > JUMP_M + LATE_S * moving.ground_mps);
        if jumps && self.doubt.is_none() {
            return self.leave(PlaceDoubt::Jumps, None, place);
        }
        if self.window.passed_s < WINDOW_S {
            return self.verdict();
        }
        if !self.moves_as_the_aircraft(place) {
            let (doubt, since) = if self.repeated.passed_s > LATE_S {
                (PlaceDoubt::Repeats, self.repeated)
            } else {
                (self.doubt.unwrap_or(PlaceDoubt::Moves), self.window)
            };
            return self.leave(doubt, Some(since), place);
        }
        self.begin_window(place);
        self.good_windows = self.good_windows.saturating_add(1);
        if self.good_windows >= GOOD_WINDOWS {
            self.doubt = None;
        }
        self.verdict()
    }

    const fn verdict(&self) -> Verdict {
        if self.doubt.is_some() {
            Verdict::Leave
        } else {
            Verdict::Use
        }
    }

    fn leave(&mut self, doubt: PlaceDoubt, since: Option<Way>, place: Place) -> Verdict {
        let before = self.doubt.replace(doubt);
        self.good_windows = 0;
        self.begin_window(place);
        match since {
            Some(since) if before.is_none() => Verdict::LeaveSince(since.from, since.by_ground_m),
            _ => Verdict::Leave,
        }
    }

    fn begin_window(&mut self, place: Place) {
        self.window = Way::since(place);
        self.by_air_m = Vector2::zeros();
        self.air_s = 0.0;
    }

    /// Whether the place is repeated although the aircraft moves.
    fn repeats_in_motion(&self, flies_mps: f64, moving: &Moving) -> bool {
        let moves = if self.velocity_s > REPEATS_S {
            moving.airspeed_mps >= flies_mps
        } else {
            moving.ground_mps > MOVES_MPS
        };
        moves && self.repeated.passed_s > REPEATS_S
    }

    /// Whether the place has moved since the comparison began as one of both ways says.
    fn moves_as_the_aircraft(&self, place: Place) -> bool {
        let moved_m = self.window.to(place);
        let passed_s = self.window.passed_s;
        let air_m = self.by_air_m;
        let off_m = |by_m: Vector2<f64>| {
            let off_m = moved_m - by_m;
            let late_m = LATE_S * hypot(by_m.x, by_m.y) / passed_s;
            hypot(off_m.x, off_m.y) - late_m - OFF_M
        };
        off_m(self.window.by_ground_m) <= 0.0 || off_m(air_m) <= MOST_WIND_MPS * passed_s
    }
}

impl Way {
    fn since(from: Place) -> Self {
        Self {
            from,
            ..Self::default()
        }
    }

    /// To a place, m north and east.
    fn to(&self, place: Place) -> Vector2<f64> {
        let [[from_rad, from_east_rad], [to_rad, to_east_rad]] = [self.from, place];
        let (north, east) = metres_per_radian(from_rad, 0.0);
        let turned_rad = fcc_core::blocks::wrap_pi(to_east_rad - from_east_rad);
        Vector2::new((to_rad - from_rad) * north, turned_rad * east)
    }
}

#[cfg(test)]
mod tests;
