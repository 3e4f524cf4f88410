//! The modes that fly over the ground: a plan, a circle, to a place, and home.

use super::{Mode, Progress, Targets};
use crate::route::{Follower, OverGround, RunwayDemand, RunwayPhase, RunwayReason, TookOff, Track};
use fcc_navigation::Estimate;

/// A mode that follows a route over the ground. It commands a bank, and no heading.
///
/// Unlike the other modes it needs a position: without one it waits, with its wings
/// level and its altitude. Its [`Progress`] has the item of a plan, from 1, and not
/// where on its way to it the aircraft was: a plan that is resumed flies there from
/// where the aircraft is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OverGroundMode {
    mode: Mode,
    follower: Follower,
    captured: Targets,
    elapsed_s: f64,
    heading_rad: f64,
    /// Pressure altitude of mean sea level, m.
    sea_level_m: f64,
}

impl OverGroundMode {
    /// A mode that begins now, with the present targets.
    pub const fn new(mode: Mode, follower: Follower, captured: Targets) -> Self {
        Self {
            mode,
            follower,
            captured,
            elapsed_s: 0.0,
            heading_rad: captured.heading_rad,
            sea_level_m: 0.0,
        }
    }

    /// Which mode it is: a plan is in another one while it takes off and lands.
    pub const fn mode(&self) -> Mode {
        match self.follower.runway() {
            None => self.mode,
            Some(_) if self.is_glide() => self.mode,
            Some(demand) => match demand.phase {
                RunwayPhase::GoAround => Mode::GoAround,
                _ if demand.takes_off => Mode::Takeoff,
                _ => Mode::Land,
            },
        }
    }

    /// Whether it flies the plan.
    pub const fn is_plan(&self) -> bool {
        matches!(self.mode, Mode::Plan)
    }

    /// Whether it glides without power.
    pub const fn is_glide(&self) -> bool {
        matches!(self.mode, Mode::Glide)
    }

    /// The take-off or landing that is flown.
    pub const fn runway(&self) -> Option<RunwayDemand> {
        self.follower.runway()
    }

    /// Whether a glide without power is in the turn to its final, or on it.
    pub const fn glides_to_land(&self) -> bool {
        self.follower.glides_to_land()
    }

    /// Whether a landing was given up so often that it is not tried again.
    pub const fn has_no_more_landings(&self) -> bool {
        self.follower.has_no_more_landings()
    }

    /// Where the last take-off began.
    pub const fn took_off(&self) -> Option<TookOff> {
        self.follower.took_off()
    }

    /// Whether it lands where it took off.
    pub const fn lands_back(&self) -> bool {
        self.follower.lands_back()
    }

    /// Gives a landing, or the roll of a take-off, up for a reason.
    pub fn go_around(&mut self, reason: RunwayReason) {
        self.follower.go_around(reason);
    }

    /// The targets for airspeed and altitude; the heading is the present one.
    pub fn targets(&self) -> Targets {
        if !self.follower.has_begun() {
            return self.captured;
        }
        Targets {
            airspeed_mps: self.follower.airspeed_mps(),
            heading_rad: self.heading_rad,
            altitude_m: self.follower.altitude_m() + self.sea_level_m,
        }
    }

    /// The acceleration to the right that is demanded, m/s².
    pub const fn acceleration_mps2(&self) -> f64 {
        self.follower.acceleration_mps2()
    }

    /// How the path is flown.
    pub const fn track(&self) -> Track {
        self.follower.track()
    }

    /// The number of the item whose end was just reached, from 1.
    pub fn reached(&self) -> Option<u16> {
        self.follower.reached().map(|index| index.saturating_add(1))
    }

    /// How far from its altitude the aircraft was there, m.
    pub const fn reached_off_m(&self) -> f64 {
        self.follower.reached_off_m()
    }

    /// Whether the plan is flown to its end, and the aircraft circles there.
    pub fn has_ended(&self) -> bool {
        self.is_plan() && self.follower.has_ended()
    }

    /// The index of the step that is flown, from 0.
    pub fn index(&self) -> usize {
        self.follower.index()
    }

    /// `dt_s` seconds pass. Mean sea level is at this pressure altitude, m.
    pub fn advance(
        &mut self,
        estimate: &Estimate,
        here: Option<&OverGround>,
        sea_level_m: f64,
        dt_s: f64,
    ) {
        self.elapsed_s += dt_s;
        self.heading_rad = estimate.heading_rad;
        self.sea_level_m = sea_level_m;
        if let Some(here) = here {
            self.follower.advance(here, dt_s);
        }
    }

    /// Its progress.
    pub fn progress(&self) -> Progress {
        let item = match self.mode {
            Mode::Plan => self.follower.index() as u32 + 1,
            _ => 0,
        };
        Progress {
            mode: self.mode(),
            item,
            elapsed_s: self.elapsed_s,
            captured: self.captured,
        }
    }

    /// The same mode, that goes on after another one.
    #[must_use]
    pub const fn again(self, captured: Targets) -> Self {
        Self { captured, ..self }
    }
}
