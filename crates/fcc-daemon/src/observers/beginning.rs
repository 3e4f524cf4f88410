//! What a user should know at the beginning of a flight.

use fcc_core::framework::Controller;
use fcc_flight::flight::{Facts, Observer, Reports};

/// Remarks that are part of the flight.
pub(crate) struct Beginning(pub(crate) Vec<String>);

impl<C: Controller> Observer<C> for Beginning {
    fn begin(&mut self, _: &Facts<'_>, reports: &mut Reports) {
        for remark in self.0.drain(..) {
            reports.remark(format!("remark: {remark}"));
        }
    }
}
