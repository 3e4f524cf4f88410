//! Checks that a release took effect, and repeats it until it has.
//!
//! The actuator sends its release three times and is then usually not called
//! again. If all three are lost, X-Plane keeps its yoke overridden. The sensor
//! is still called and reads the overrides: while a released override is still
//! set, it sends the release again.
//!
//! A write from before the release may arrive after it, late or doubled, and set
//! an override again. So the overrides are read for [`DOUBLED_WRITES`] after the
//! release, and released again unless another program set them: the yoke of
//! that one moves to where this program did not put it. In the first
//! [`LATE_WRITES`] of it, and while one is set again, the controls count as held:
//! the end of the program then waits until they stay free.

use core::time::Duration;
use std::net::SocketAddr;

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
/// A write may arrive this long after it was sent. This is an assumption: a full
/// queue in a home router delays by up to about 2 s, and this is twice as much
/// and a reserve.
const LATE_WRITES: Duration = Duration::from_secs(5);
/// A write may arrive once more this long after the release: a network that repeats old
/// datagrams. One of 25 s was seen.
const DOUBLED_WRITES: Duration = Duration::from_secs(60);
/// In this time an override is released again so many times at most.
const MOST_TIMES_AGAIN: u8 = 100;
/// An override that is set again is released after this long, in which the yoke
/// of another program moves, which writes it in each frame.
const LOOKED_AT_FOR: Duration = Duration::from_millis(250);
/// The yoke may still be read where it was before the override.
const YOKE_AFTER: Duration = Duration::from_millis(100);
/// A difference of the yoke that is no rounding error.
const MOVED: f32 = 1e-6;

const OVERRIDES: [Quantity; 2] = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];
const YOKE: [Quantity; 3] = [
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
];

/// Monitors the overrides after a release.
#[derive(Debug)]
pub(crate) struct ReleaseMonitor {
    controls: Controls,
    /// Since when control is being released; never while it is not.
    since: Time,
    sent: Time,
    times: u8,
    /// Until when a release of this program's may be undone by a late write, and by a doubled
    /// one.
    late_until: Time,
    doubled_until: Time,
    /// Where it was released.
    simulator: Option<SocketAddr>,
    /// Since when an override is set again; never while none is.
    set_again: Time,
    /// Where the yoke was then.
    yoke: [Option<f32>; 3],
}

impl ReleaseMonitor {
    pub(crate) const fn new(controls: Controls) -> Self {
        Self {
            controls,
            since: Time::NEVER,
            sent: Time::NEVER,
            times: 0,
            late_until: Time::NEVER,
            doubled_until: Time::NEVER,
            simulator: None,
            set_again: Time::NEVER,
            yoke: [None; 3],
        }
    }

    /// Checks the overrides, and sends the release again if one is still set,
    /// or set again.
    pub(crate) fn poll(
        &mut self,
        now: Time,
        link: &SharedState,
        send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        match link.control() {
            Control::Held => {
                self.since = Time::NEVER;
                self.end_watch(link);
            }
            Control::ReleaseMonitor => return self.repeat(now, link, send),
            Control::Free => {
                self.since = Time::NEVER;
                if !self.doubled_until.is_never() && self.is_undone(now, link) {
                    link.set_releasing_if_free();
                    return self.repeat(now, link, send);
                }
            }
        }
        Ok(())
    }

    /// Sends the release again until it is confirmed.
    fn repeat(
        &mut self,
        now: Time,
        link: &SharedState,
        send: impl FnMut(&[u8]) -> Result<(), Errno>,
    ) -> Result<(), Errno> {
        let again = !self.set_again.is_never();
        if again && self.is_moved_by_another(now, link) {
            self.end_watch(link);
            link.set_free_if_releasing();
            return Ok(());
        }
        if self.since.is_never() {
            self.since = now;
            self.sent = now;
            if again {
                self.times += 1;
                return self.controls.release(send);
            }
            self.times = 0;
            // What an earlier program left set was written by that one.
            if !link.sent_yoke.is_empty() {
                self.late_until = now + LATE_WRITES;
                self.doubled_until = now + DOUBLED_WRITES;
                self.simulator = link.address.simulator();
                link.set_may_be_undone(true);
            }
        }
        let most_times = if again { MOST_TIMES_AGAIN } else { MOST_TIMES };
        let settled = self.since + SETTLED_AFTER;
        // An override without a readback does not exist in this simulator.
        let readback = OVERRIDES.map(|quantity| link.read_back.shown(quantity));
        let readback = readback.iter().flatten();
        let still_set = readback
            .clone()
            .any(|(value, at)| *value >= 0.5 && *at > settled && *at > self.sent);
        let all_clear = link.is_answer_of_flown()
            && readback.clone().count() > 0
            && readback
                .clone()
                .all(|(value, at)| *value < 0.5 && *at > settled);
        if all_clear {
            self.set_again = Time::NEVER;
            link.set_free_if_releasing();
        } else if still_set && now.since(self.sent) >= AGAIN_AFTER && self.times < most_times {
            self.sent = now;
            self.times += 1;
            return self.controls.release(send);
        }
        Ok(())
    }

    /// Whether an override is set again, not by another program, after a
    /// release that was confirmed.
    fn is_undone(&mut self, now: Time, link: &SharedState) -> bool {
        if link.address.simulator() != self.simulator {
            self.end_watch(link);
            return false;
        }
        let is_set = OVERRIDES
            .iter()
            .filter_map(|quantity| link.read_back.shown(*quantity))
            .any(|(value, at)| value >= 0.5 && now.since(at) < LOOKED_AT_FOR);
        if !is_set {
            self.set_again = Time::NEVER;
            if now >= self.late_until {
                link.set_may_be_undone(false);
            }
            if now >= self.doubled_until {
                self.end_watch(link);
            }
            return false;
        }
        link.set_may_be_undone(true);
        if self.set_again.is_never() {
            self.set_again = now;
        }
        if self.times >= MOST_TIMES_AGAIN || self.is_moved_by_another(now, link) {
            self.end_watch(link);
            return false;
        }
        now.since(self.set_again) >= LOOKED_AT_FOR
    }

    /// Whether the yoke is where this program did not put it, and where it was
    /// not when the override was set.
    fn is_moved_by_another(&mut self, now: Time, link: &SharedState) -> bool {
        let yoke = YOKE.map(|axis| link.read_back.shown(axis).map(|(value, _)| value));
        if now.since(self.set_again) < YOKE_AFTER {
            self.yoke = yoke;
            return false;
        }
        let pairs = yoke.into_iter().zip(self.yoke).enumerate();
        pairs
            .filter_map(|(axis, (is, was))| Some((axis, is?, was?)))
            .any(|(axis, is, was)| (is - was).abs() > MOVED && !link.sent_yoke.holds(axis, is))
    }

    fn end_watch(&mut self, link: &SharedState) {
        self.doubled_until = Time::NEVER;
        self.set_again = Time::NEVER;
        link.set_may_be_undone(false);
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
