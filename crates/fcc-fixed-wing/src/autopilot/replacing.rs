//! The plan is replaced in flight: in one piece, by the tick that reads the command.
//!
//! A plan that replaces another one was read, checked and put with the
//! [prepared routes](fcc_guidance::route::PreparedRoutes) before the command was sent.
//! From its tick on everything that depends on the plan is the new one's: items, fence,
//! places to return to, and the hash in the record. What is not replaced stays as it is,
//! and the answer says why.

use super::Autopilot;
use super::refusal::Refusal;
use fcc_core::schema;
use fcc_guidance::Mode;
use fcc_guidance::route::{Route, RunwayPhase};

schema! {
    /// Which plan is to replace the one that is flown.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct PlanReplacement {
        /// The first 64 bits of the SHA-256 of its content.
        #[field(1)]
        pub plan_hash: u64,
        /// When it was uploaded, s since 1970 (UTC).
        #[field(2)]
        pub plan_uploaded_unix_s: u64,
        /// The item that it is flown from, from 1; 0 after a restart, where
        /// [`Resume`](super::Resume) follows and says what is flown.
        #[field(3)]
        pub item: u16,
    }
}

impl Autopilot {
    /// Replaces the plan, or says why not.
    pub(super) fn replace_plan(&mut self, replacement: &PlanReplacement) {
        let answer = match self.replaced_by(replacement) {
            Ok(route) => {
                self.supervisor.contingencies.end();
                self.config.plan = Some(route);
                let index = usize::from(replacement.item.saturating_sub(1));
                self.begin_plan(&route, index);
                // Nothing leads back to the plan before.
                self.supervisor.left_plan = None;
                0
            }
            Err(refusal) => refusal as u16,
        };
        self.answer(answer, replacement.item);
    }

    fn replaced_by(&self, replacement: &PlanReplacement) -> Result<Route<'static>, Refusal> {
        if self.guidance.mode.mode() == Mode::None {
            return Err(Refusal::NotEngaged);
        }
        let config = &self.config;
        let route = config.prepared.route(replacement.plan_hash, &config.route);
        let route = route.ok_or(Refusal::NotPrepared)?;
        let index = usize::from(replacement.item.saturating_sub(1));
        route.step(index).ok_or(Refusal::NoSuchItem)?;
        // After a restart the mode that is resumed says what is flown.
        if replacement.item > 0 {
            self.estimator.ground.here().ok_or(Refusal::NoPosition)?;
            self.may_leave_runway()?;
        }
        Ok(Route {
            uploaded_unix_s: replacement.plan_uploaded_unix_s,
            ..route
        })
    }

    /// Whether the plan may change over a runway.
    fn may_leave_runway(&self) -> Result<(), Refusal> {
        let Some(demand) = self.guidance.runway() else {
            return Ok(());
        };
        let climbs = matches!(demand.phase, RunwayPhase::Climb | RunwayPhase::GoAround);
        let is_high = demand.height_m >= self.config.route.runway.decision_height_m;
        match demand.phase {
            _ if climbs && is_high => Ok(()),
            phase if phase.is_takeoff() || climbs => Err(Refusal::TakingOff),
            _ => Err(Refusal::Landing),
        }
    }
}
