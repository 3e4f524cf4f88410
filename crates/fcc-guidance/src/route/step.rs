//! A plan in the form that a tick reads: in radians, metres and planes.

use crate::fence::Fence;
use crate::path::{LocalPlane, length};
use fcc_core::flight::terrain::Obstacle;

use super::{OverGround, Runway};

/// Jumps of a route that end: each has a counter in the [`Follower`](super::Follower).
pub const JUMPS: usize = 32;
/// [`Step::Jump::times`] of one that never ends.
pub const FOR_EVER: u16 = u16::MAX;

/// When a loiter ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Until {
    /// Never.
    Never,
    /// After it has turned so far around its centre, rad.
    Turned(f64),
    /// After so long on the circle, s.
    Elapsed(f64),
    /// When its altitude is reached.
    AtAltitude,
}

/// One step of a route.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Step {
    /// Fly to a place.
    Waypoint {
        /// The place.
        at: LocalPlane,
        /// Reached there, m above mean sea level.
        altitude_m: f64,
        /// The aircraft passes it within this distance, m; infinite if it does not
        /// matter.
        within_m: f64,
    },
    /// Circle around a place.
    Loiter {
        /// The centre; none: to the side of where the aircraft is when it begins.
        at: Option<LocalPlane>,
        /// m above mean sea level.
        altitude_m: f64,
        /// m, positive.
        radius_m: f64,
        /// The way around, from above.
        clockwise: bool,
        /// When it ends.
        until: Until,
        /// Leave it only in the direction of the next place.
        leave_towards_next: bool,
    },
    /// Fly to the nearest of [`Route::returns`], and circle there.
    Return,
    /// Another indicated airspeed from now on, m/s.
    Airspeed(f64),
    /// Another speed over the ground from now on, m/s.
    GroundSpeed(f64),
    /// Another altitude from now on, m above mean sea level.
    Altitude(f64),
    /// What follows takes effect after this time, s, or at the next place.
    Delay(f64),
    /// What follows takes effect when the next place is so near, m.
    UntilDistance(f64),
    /// Continue at another step.
    Jump {
        /// Its index, from 0.
        to: u16,
        /// How often, or [`FOR_EVER`].
        times: u16,
        /// Its counter, below [`JUMPS`]; of one that never ends it is not used.
        counter: u8,
    },
    /// Take off, and climb straight ahead to an altitude.
    Takeoff {
        /// The centre line; none: straight ahead from where the aircraft stands.
        runway: Option<Runway>,
        /// It is done there, m above mean sea level.
        altitude_m: f64,
        /// Pitch of the climb, rad; none: the usual one.
        pitch_rad: Option<f64>,
    },
    /// Land, in the direction of the leg that leads there.
    Land {
        /// Where to touch down.
        at: LocalPlane,
        /// Of the runway, m above mean sea level.
        elevation_m: f64,
        /// To climb to when it is given up, m above mean sea level.
        abort_altitude_m: f64,
    },
    /// Land where the last take-off began, in its direction; where that is not known,
    /// return.
    LandBack {
        /// Above where it stood: of the circle from which the landing begins, and of a
        /// go-around, m.
        height_m: f64,
    },
    /// The landing sequence begins here: it is flown again after a go-around.
    LandStart,
    /// Nothing is done: a mark.
    Mark,
}

impl Step {
    /// Whether it is flown, and does not only take effect.
    pub const fn is_flown(&self) -> bool {
        matches!(
            self,
            Self::Waypoint { .. }
                | Self::Loiter { .. }
                | Self::Return
                | Self::Takeoff { .. }
                | Self::Land { .. }
                | Self::LandBack { .. }
        )
    }
}

/// A place to return to.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Destination {
    /// The place.
    pub at: LocalPlane,
    /// The altitude there, m above mean sea level.
    pub altitude_m: f64,
}

/// A route: a plan's items, made before the flight.
///
/// ```
/// use fcc_guidance::path::LocalPlane;
/// use fcc_guidance::route::{Route, Step};
///
/// let steps = [Step::Waypoint {
///     at: LocalPlane::at(0.8, 0.1),
///     altitude_m: 900.0,
///     within_m: f64::INFINITY,
/// }];
/// let route = Route { steps: &steps, ..Route::default() };
/// assert!(route.step(0).is_some_and(Step::is_flown));
/// assert!(route.step(1).is_none());
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Route<'a> {
    /// Its steps; the index of each is the number of the plan's item less 1.
    pub steps: &'a [Step],
    /// Home and the other places to return to.
    pub returns: &'a [Destination],
    /// Where the aircraft may fly.
    pub fence: Fence<'a>,
    /// Where it returns to from the fence; none: as from elsewhere.
    pub fence_return: Option<Destination>,
    /// What it must not fly into.
    pub obstacles: &'a [Obstacle],
    /// Indicated airspeed of its first leg, m/s; none: that at its begin.
    pub airspeed_mps: Option<f64>,
    /// The first 64 bits of the SHA-256 of the plan's content.
    pub hash: u64,
    /// When it was uploaded, s since 1970 (UTC).
    pub uploaded_unix_s: u64,
}

impl Route<'_> {
    /// The step with this index, from 0.
    pub fn step(&self, index: usize) -> Option<&Step> {
        self.steps.get(index)
    }

    /// Whether no jump is taken for ever.
    pub fn has_end(&self) -> bool {
        let is_endless =
            |step: &Step| matches!(step, Step::Jump { times, .. } if *times == FOR_EVER);
        !self.steps.iter().any(is_endless)
    }

    /// The nearest of the places to return to.
    pub fn nearest_return(&self, here: &OverGround) -> Option<Destination> {
        nearest_of(self.returns, here)
    }
}

/// The nearest of some places.
pub(super) fn nearest_of(places: &[Destination], here: &OverGround) -> Option<Destination> {
    let away_m = |place: &Destination| length(here.motion_in(&place.at).position_m);
    let nearer = |a: &&Destination, b: &&Destination| away_m(a).total_cmp(&away_m(b));
    places.iter().min_by(nearer).copied()
}
