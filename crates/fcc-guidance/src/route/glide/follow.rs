//! The follower of a route that glides.

use super::{GlideConfig, GlideFlight};
use crate::route::follower::{Follower, Phase};
use crate::route::sequence::Steps;
use crate::route::{OverGround, Route, RouteConfig};

impl Follower {
    /// A glide without power to the best place to land at that a route has.
    pub fn gliding(route: Route<'static>, config: RouteConfig, glide: GlideConfig) -> Self {
        let mut follower = Self::new(
            Steps::Plan(route),
            route.returns,
            0,
            config,
            glide.airspeed_mps,
        );
        follower.phase = Phase::Glide(GlideFlight::new(glide));
        follower
    }

    /// One tick of a glide, which ends in a landing.
    pub(in crate::route) fn glide_on(
        &mut self,
        mut flight: GlideFlight,
        here: &OverGround,
        dt_s: f64,
    ) {
        let landing = flight.step(self.sequence.route(), &self.config, here, dt_s);
        self.phase = landing.map_or(Phase::Glide(flight), Phase::Runway);
        self.goal.at = landing.map_or(flight.at, |landing| landing.runway.at);
        self.goal.altitude_m =
            landing.map_or(flight.elevation_m, |landing| landing.runway.elevation_m);
    }
}
