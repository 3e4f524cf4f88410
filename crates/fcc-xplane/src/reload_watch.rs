//! Whether X-Plane has loaded an aircraft anew.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::link::{Control, SharedState};
use crate::quantity::Quantity;

/// How long a second reading of both overrides is waited for: some frames.
const RELOADS_WITHIN: Duration = Duration::from_millis(250);

/// Notices that both overrides, which were set, are cleared although control is held, in
/// two ticks: X-Plane clears them when it loads an aircraft. One of them alone may be
/// another program's doing; it is set again.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ReloadWatch {
    /// Whether both overrides were seen set since control was taken.
    overridden: bool,
    /// When both were first read as cleared after that; never while they are not.
    cleared: Time,
}

impl ReloadWatch {
    /// One tick; whether an aircraft was loaded.
    pub(crate) fn step(&mut self, now: Time, link: &SharedState) -> bool {
        let overrides = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];
        let shown = overrides.map(|of| link.read_back.shown(of));
        let [first, second] = shown.map(|shown| shown.map(|(value, _)| value >= 0.5));
        let is_cleared = first == Some(false) && second == Some(false);
        let mut is_loaded = false;
        if link.control() != Control::Held {
            self.overridden = false;
        } else if first == Some(true) && second == Some(true) {
            self.overridden = true;
        }
        if !is_cleared || !self.overridden {
            self.cleared = Time::NEVER;
        } else if self.cleared.is_never() {
            self.cleared = now;
        } else if shown.iter().flatten().all(|(_, at)| *at > self.cleared) {
            self.overridden = false;
            is_loaded = true;
        }
        // They must not be set again before the second reading.
        link.set_maybe_reloaded(
            !self.cleared.is_never() && now.since(self.cleared) < RELOADS_WITHIN,
        );
        is_loaded
    }
}
