//! How a flight plan was flown.

use std::cell::RefCell;
use std::rc::Rc;

use fcc_core::framework::{EventKind, EventOf};
use fcc_fixed_wing::Autopilot;
use fcc_flight::flight::{FlightTime, Observer};
use fcc_report::FlownPlan;
use fcc_telemetry::FlightRecord;

/// Follows the items and the touch-down, as a report on the recording does.
#[derive(Clone, Default)]
pub(crate) struct PlanResult(pub(crate) Rc<RefCell<FlownPlan>>);

impl Observer<Autopilot> for PlanResult {
    fn record(&mut self, record: &FlightRecord, at: &FlightTime) {
        self.0.borrow_mut().take(record, at.time_s);
    }

    fn event(&mut self, event: &EventOf<Autopilot>, _: &str, _: &FlightTime) {
        if let EventKind::Noticed(notice) = &event.kind {
            self.0.borrow_mut().notice(notice);
        }
    }
}
