//! Checks that a release took effect, and repeats it until it has.
//!
//! The actuator sends its release three times and is then usually not called
//! again. If all three are lost, X-Plane keeps its yoke overridden. The sensor
//! is still called and reads the overrides: while a released override is still
//! set, it sends the release again.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::controls::Controls;
use crate::link::{Control, SharedState};
use crate::port::Errno;
use crate::quantity::Quantity;

/// A readback earlier than this after a release may be from before it.
const SETTLED_AFTER: Duration = Duration::from_millis(200);
/// The interval between two releases.
const AGAIN_AFTER: Duration = Duration::from_millis(250);
/// After this many releases (10 s) another program holds the override, and
/// keeps it.
const MOST_TIMES: u8 = 40;

/// Monitors the overrides after a release.
#[derive(Debug)]
pub(crate) struct ReleaseMonitor {
    controls: Controls,
    /// Since when control is being released; never while it is not.
    since: Time,
    sent: Time,
    times: u8,
}

impl ReleaseMonitor {
    pub(crate) const fn new(controls: Controls) -> Self {
        Self {
            controls,
            since: Time::NEVER,
            sent: Time::NEVER,
            times: 0,
        }
    }

    /// Checks the overrides, and sends the release again if one is still set.
    pub(crate) fn poll(
        &mut self,
        now: Time,
        link: &SharedState,
        send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        if link.control() != Control::ReleaseMonitor {
            self.since = Time::NEVER;
            return Ok(());
        }
        if self.since.is_never() {
            self.since = now;
            self.sent = now;
            self.times = 0;
        }
        let settled = self.since + SETTLED_AFTER;
        // An override without a readback does not exist in this simulator.
        let readback = [Quantity::OverrideJoystick, Quantity::OverrideThrottles]
            .map(|quantity| link.read_back.shown(quantity));
        let readback = readback.iter().flatten();
        let still_set = readback
            .clone()
            .any(|(value, at)| *value >= 0.5 && *at > settled && *at > self.sent);
        let all_clear = readback.clone().count() > 0
            && readback
                .clone()
                .all(|(value, at)| *value < 0.5 && *at > settled);
        if all_clear {
            link.set_free_if_releasing();
        } else if still_set && now.since(self.sent) >= AGAIN_AFTER && self.times < MOST_TIMES {
            self.sent = now;
            self.times += 1;
            return self.controls.release(send);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::XPlaneConfig;

    const TICK: Duration = Duration::from_millis(25);

    /// Runs ticks in which the simulator sends its overrides; returns the
    /// number of datagrams sent in each.
    fn watch(
        release_monitor: &mut ReleaseMonitor,
        link: &SharedState,
        now: &mut Time,
        ticks: u32,
        overrides: [f64; 2],
    ) -> usize {
        let mut sent = 0;
        for _ in 0..ticks {
            *now = *now + TICK;
            link.read_back
                .show(Quantity::OverrideJoystick, overrides[0], *now);
            link.read_back
                .show(Quantity::OverrideThrottles, overrides[1], *now);
            release_monitor
                .poll(*now, link, |_| {
                    sent += 1;
                    Ok(())
                })
                .unwrap();
        }
        sent
    }

    fn bench() -> (ReleaseMonitor, SharedState, Time) {
        let controls = Controls::new(&XPlaneConfig::default()).unwrap();
        (
            ReleaseMonitor::new(controls),
            SharedState::new(None),
            Time::from_nanos(1_000_000_000),
        )
    }

    #[test]
    fn an_override_of_another_program_is_not_cleared() {
        let (mut release_monitor, link, mut now) = bench();
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 400, [1.0, 1.0]),
            0
        );
        link.set_control(Control::Held);
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 400, [1.0, 1.0]),
            0
        );
    }

    #[test]
    fn a_confirmed_release_is_free_at_once() {
        let (mut release_monitor, link, mut now) = bench();
        link.set_control(Control::ReleaseMonitor);
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 20, [0.0, 0.0]),
            0
        );
        assert_eq!(link.control(), Control::Free);
    }

    #[test]
    fn an_override_that_is_still_set_is_released_again() {
        let (mut release_monitor, link, mut now) = bench();
        link.set_control(Control::ReleaseMonitor);
        // Five datagrams each: three surfaces, two overrides.
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 12, [0.0, 1.0]),
            5
        );
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 20, [0.0, 1.0]),
            10
        );
        assert_eq!(link.control(), Control::ReleaseMonitor);
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 2, [0.0, 0.0]),
            0
        );
        assert_eq!(link.control(), Control::Free);
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 40, [1.0, 1.0]),
            0
        );
    }

    #[test]
    fn repeating_stops_after_ten_seconds_if_another_program_sets_it() {
        let (mut release_monitor, link, mut now) = bench();
        link.set_control(Control::ReleaseMonitor);
        let sent = watch(&mut release_monitor, &link, &mut now, 2_000, [1.0, 1.0]);
        assert_eq!(sent, 40 * 5);
    }
}
