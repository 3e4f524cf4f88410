//! Take-off and landing as steps of a route.

use super::OverGround;
use super::back::TookOff;
use super::follower::{Follower, Phase};
use super::runway::{Outcome, RunwayDemand, RunwayFlight, RunwayReason};
use crate::path::Motion;

/// A landing that was given up so often is not tried again by itself.
const MOST_LANDINGS: u8 = 3;

impl Follower {
    /// With the runway of a take-off before, to land on.
    #[must_use]
    pub const fn after(mut self, took_off: Option<TookOff>) -> Self {
        self.took_off = took_off;
        self
    }

    /// Where the last take-off began.
    pub const fn took_off(&self) -> Option<TookOff> {
        self.took_off
    }

    /// Whether it lands where it took off.
    pub const fn lands_back(&self) -> bool {
        self.sequence.lands_back()
    }

    /// The take-off or landing that is flown.
    pub const fn runway(&self) -> Option<RunwayDemand> {
        match &self.phase {
            Phase::Runway(flight) => Some(flight.demand()),
            _ => None,
        }
    }

    /// Whether a glide without power is in the turn to its final, or on it.
    pub const fn glides_to_land(&self) -> bool {
        matches!(&self.phase, Phase::Glide(flight) if flight.is_on_final())
    }

    /// Whether a landing was given up so often that it is not tried again.
    pub const fn has_no_more_landings(&self) -> bool {
        self.given_up >= MOST_LANDINGS
    }

    /// Gives a landing, or the roll of a take-off, up for a reason.
    pub fn go_around(&mut self, reason: RunwayReason) {
        if let Phase::Runway(flight) = &mut self.phase {
            flight.go_around(reason);
        }
    }

    /// One tick on a runway or over it; whether another step is flown, or elsewhere.
    pub(super) fn step_runway(
        &mut self,
        mut flight: RunwayFlight,
        here: &OverGround,
        motion: &Motion,
        dt_s: f64,
    ) -> bool {
        let outcome = flight.step(here, motion, dt_s);
        self.phase = Phase::Runway(flight);
        self.took_off = flight.took_off().or(self.took_off);
        self.ground_above_m = flight
            .ground_above_m()
            .map(|above_m| (self.goal.at, above_m));
        if flight.runway.at != self.goal.at {
            // It was thrown elsewhere.
            self.goal.at = flight.runway.at;
            return true;
        }
        match outcome {
            Outcome::Done => {
                self.reach(0.0);
                return self.go_on(&here.plane(), here);
            }
            Outcome::Stands => self.reach(0.0),
            Outcome::Again => {
                let commanded = flight.demand().reason == RunwayReason::Commanded;
                self.given_up += u8::from(!commanded);
                if self.has_no_more_landings() {
                    self.circle_over(flight.altitude_m);
                    return true;
                }
                let again = self.sequence.before_landing(self.index);
                self.begin(again.unwrap_or(self.index), &here.plane(), here);
                return true;
            }
            Outcome::Flown => {}
        }
        false
    }
}
