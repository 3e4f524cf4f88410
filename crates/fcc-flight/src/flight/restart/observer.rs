//! In-flight recovery as an observer of the flight.

use std::sync::Arc;

use fcc_core::framework::{ControlAuthority, Message};
use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_telemetry::{FlightEvent, FlightRecord};

use super::super::observer::{Access, Facts, FlightTime, Observer, Report, Reports};
use super::super::outcome::Outcome;
use super::{Restart, RestartRequest};

/// Stores the state of the flight from its beginning to its end, and recovers
/// an interrupted one.
pub(in crate::flight) struct RestartKeeper {
    request: Option<RestartRequest>,
    restart: Option<Restart>,
    authority: Option<Arc<dyn ControlAuthority>>,
}

impl RestartKeeper {
    pub(in crate::flight) const fn new(
        request: RestartRequest,
        authority: Option<Arc<dyn ControlAuthority>>,
    ) -> Self {
        Self {
            request: Some(request),
            restart: None,
            authority,
        }
    }

    /// Releases what an interrupted flight left held, once it is known not to
    /// be recovered.
    fn release_left(&mut self) {
        if let Some((restart, authority)) = self.restart.as_mut().zip(self.authority.as_ref())
            && restart.takes_over_release()
        {
            authority.release_left();
        }
    }
}

impl Observer<Autopilot> for RestartKeeper {
    fn begin(&mut self, _: &Facts<'_>, reports: &mut Reports) {
        if let Some(request) = self.request.take() {
            let (restart, words) = Restart::begin(request);
            self.restart = restart;
            if let Some(words) = words {
                reports.remark(words);
            }
        }
        self.release_left();
    }

    fn record(&mut self, record: &FlightRecord, _: &FlightTime) {
        if let Some(restart) = &mut self.restart {
            restart.take(&Message::Tick(*record));
        }
    }

    fn event(&mut self, event: &FlightEvent, _: &str, _: &FlightTime) {
        if let Some(restart) = &mut self.restart {
            restart.take(&Message::Event(*event));
        }
    }

    fn report(&mut self, report: &Report, _: &FlightTime) {
        if let (Some(restart), Report::Plan(plan)) = (&mut self.restart, report) {
            restart.plans().note(Arc::clone(plan));
        }
    }

    fn poll(&mut self, access: &mut Access<'_, AutopilotCommand>) {
        let restored = self
            .restart
            .as_mut()
            .map(|restart| restart.plans().report());
        if let Some(plan) = restored.flatten() {
            access.reports.plan(plan);
        }
        if let Some(restart) = &mut self.restart
            && let Some(words) = restart.poll(access.commands, &mut *access.before_control)
        {
            access.reports.remark(words);
        }
        self.release_left();
    }

    fn end(&mut self, _: &str, _: &mut Outcome, _: &mut Reports) {
        if let Some(restart) = self.restart.take() {
            restart.end();
        }
    }
}
