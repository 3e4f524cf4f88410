//! Reports a servo board's messages that arrive late.

use std::time::Instant;

use fcc_core::framework::Controller;
use fcc_servo_link::LinkStatus;
use fcc_xplane::OldDatagrams;

use super::observer::{Access, Observer};

/// Watches the link.
pub(super) struct LineWatch {
    link: LinkStatus,
    old: OldDatagrams,
}

impl LineWatch {
    pub(super) fn new(link: LinkStatus) -> Self {
        Self {
            link,
            old: OldDatagrams::default(),
        }
    }
}

impl<C: Controller> Observer<C> for LineWatch {
    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        let late = self.link.messages.counts().late;
        if let Some(rate) = self.old.step(Instant::now(), late) {
            access.reports.remark(format!(
                "servo board: {rate:.0} messages a second are older than others that arrived \
                 before, and are not used: the network delivers them late or twice"
            ));
        }
    }
}
