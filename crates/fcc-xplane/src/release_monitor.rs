//! Seeing to it that control that was given back is really back.
//!
//! The actuator sends its letting go three times and is then, as a rule, not
//! called again. Should all three get lost, X-Plane would fly on with its yoke
//! held. The sensor is still called, and sees the overrides: while one that was
//! released still shows as set, it sends the letting go again.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::controls::Controls;
use crate::link::{Control, SharedState};
use crate::port::Errno;
use crate::quantity::Quantity;

/// What shows earlier than this after letting go may be from before.
const SETTLED_AFTER: Duration = Duration::from_millis(200);
/// Between one letting go and the next.
const AGAIN_AFTER: Duration = Duration::from_millis(250);
/// After so many (10 s) somebody else holds the override, and keeps it.
const MOST_TIMES: u8 = 40;

/// Watches the overrides after control was given back.
#[derive(Debug)]
pub(crate) struct ReleaseMonitor {
    controls: Controls,
    /// Since when control is being given back; never while it is not.
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

    /// Looks at the overrides, and sends the letting go again if one is still
    /// set.
    pub(crate) fn see_to_it(
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
        // An override that never showed is one that this simulator lacks.
        let shown = [Quantity::OverrideJoystick, Quantity::OverrideThrottles]
            .map(|quantity| link.shown(quantity));
        let shown = shown.iter().flatten();
        let still_set = shown
            .clone()
            .any(|(value, at)| *value >= 0.5 && *at > settled && *at > self.sent);
        let all_clear = shown.clone().count() > 0
            && shown
                .clone()
                .all(|(value, at)| *value < 0.5 && *at > settled);
        if all_clear {
            link.set_free_if_releasing();
        } else if still_set && now.since(self.sent) >= AGAIN_AFTER && self.times < MOST_TIMES {
            self.sent = now;
            self.times += 1;
            return self.controls.let_go(send);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::XPlaneConfig;

    const TICK: Duration = Duration::from_millis(25);

    /// So many ticks in which the simulator shows its overrides; how many
    /// datagrams were sent in each.
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
            link.show(Quantity::OverrideJoystick, overrides[0], *now);
            link.show(Quantity::OverrideThrottles, overrides[1], *now);
            release_monitor
                .see_to_it(*now, link, |_| {
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
    fn an_override_that_is_not_ours_is_left_alone() {
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
    fn released_and_seen_released_is_free_at_once() {
        let (mut release_monitor, link, mut now) = bench();
        link.set_control(Control::ReleaseMonitor);
        assert_eq!(
            watch(&mut release_monitor, &link, &mut now, 20, [0.0, 0.0]),
            0
        );
        assert_eq!(link.control(), Control::Free);
    }

    #[test]
    fn one_that_still_shows_is_released_again_until_it_is() {
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
    fn somebody_who_keeps_setting_it_wins_after_ten_seconds() {
        let (mut release_monitor, link, mut now) = bench();
        link.set_control(Control::ReleaseMonitor);
        let sent = watch(&mut release_monitor, &link, &mut now, 2_000, [1.0, 1.0]);
        assert_eq!(sent, 40 * 5);
    }
}
