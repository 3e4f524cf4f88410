//! Checks that the written controls take effect.
//!
//! X-Plane sends no acknowledgement, and it sends data even if its input is
//! switched off or blocked by a firewall. So the overrides and the yoke are
//! read back while they are written. Writing is confirmed as long as every
//! recent readback agrees with what was recently sent. The throttle itself is
//! not compared, since the engine model may change it, but its override is.
//!
//! Another program that writes the yoke is found by the same comparison: the
//! override is set, and the yoke is again and again where it was not put. A yoke
//! that stands still where it was put before is nobody's: what is written does
//! not arrive any more.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::lasting::Lasting;
use crate::link::SharedState;
use crate::quantity::Quantity;
use crate::round_trip::RoundTrip;
use crate::simulator::SimulatorState;
use crate::written::{ReadBack, Written};

/// The longest time for which writing may be unconfirmed.
pub(crate) const CONFIRMED_WITHIN: Duration = Duration::from_secs(1);
/// A readback counts as recent for this long.
const LATELY: Duration = Duration::from_millis(500);
/// A difference of the yoke that is no rounding error.
const STILL: f32 = 1e-6;
/// How far a readback may lie outside the recently sent values: rounding, if
/// the simulator stores the ratio in another form.
const TOLERANCE: f32 = 0.02;

/// Another program writes the yoke once it has been where it was not put at
/// intervals of less than [`LATELY`] for this long: a freeze of the simulator,
/// after which it processes what it had queued, is shorter.
const CONTESTED_AFTER: Duration = Duration::from_millis(1500);
const CONTESTED_UNTIL: Duration = Duration::from_secs(5);

const YOKE: [Quantity; 3] = [
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
];
const OVERRIDES: [Quantity; 2] = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];

/// The least and the greatest value written in a period.
#[derive(Clone, Copy, Debug)]
struct Extent {
    least: f32,
    greatest: f32,
}

impl Extent {
    const EMPTY: Self = Self {
        least: f32::INFINITY,
        greatest: f32::NEG_INFINITY,
    };

    fn add(&mut self, value: f32) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    fn of(periods: [Self; 3]) -> Self {
        periods.into_iter().fold(Self::EMPTY, |all, period| Self {
            least: all.least.min(period.least),
            greatest: all.greatest.max(period.greatest),
        })
    }

    fn holds(self, value: f32) -> bool {
        (self.least - TOLERANCE..=self.greatest + TOLERANCE).contains(&value)
    }
}

/// Compares the written values with their readback.
#[derive(Clone, Debug)]
pub(crate) struct Confirmation {
    /// When control was taken.
    began: Time,
    confirmed: Time,
    /// What was written to each axis in the current and in the two previous
    /// half seconds: a readback is delayed by the round trip, up to a second.
    extents: [[Extent; 3]; 3],
    turned: Time,
    written: Written,
    /// Where each axis was last read as it was put.
    ours: [Option<f32>; 3],
    /// The yoke stands there although something else was put.
    cut: Lasting,
    /// When the yoke was last read where it was not put.
    moved_by_another: Time,
    contested: Lasting,
    round_trip: RoundTrip,
    /// How long the overrides have been waited for while data arrived, and until when; none
    /// once they were read back.
    awaited: Option<(Duration, Time)>,
}

impl Confirmation {
    /// Starts when control is taken.
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            began: now,
            confirmed: now,
            extents: [[Extent::EMPTY; 3]; 3],
            turned: now,
            written: Written::new(),
            ours: [None; 3],
            cut: Lasting::new(CONTESTED_AFTER, LATELY),
            moved_by_another: Time::NEVER,
            contested: Lasting::new(CONTESTED_AFTER, CONTESTED_UNTIL),
            round_trip: RoundTrip::begin(now),
            awaited: Some((Duration::ZERO, now)),
        }
    }

    /// Waits until the overrides are read back for the first time: the first round trip. A
    /// simulator that stops meanwhile says nothing of the network.
    pub(crate) fn await_overrides(&mut self, now: Time, link: &SharedState) {
        let Some((mut waited, before)) = self.awaited else {
            return;
        };
        if matches!(link.state(), SimulatorState::Running | SimulatorState::Slow) {
            waited += now.since(before);
        }
        let is_there = |quantity| {
            self.recent(quantity, now, link)
                .is_some_and(|(value, _)| value >= 0.5)
        };
        self.awaited = if OVERRIDES.into_iter().all(is_there) {
            self.round_trip.is_at_first(waited);
            None
        } else {
            Some((waited, now))
        };
    }

    /// Records what was written to elevator, aileron and rudder.
    pub(crate) fn wrote(&mut self, now: Time, yoke: [Option<f32>; 3]) {
        self.written.add(now, yoke);
        if now.since(self.turned) >= LATELY {
            self.turned = now;
            for [present, before, earliest] in &mut self.extents {
                *earliest = *before;
                *before = *present;
                *present = Extent::EMPTY;
            }
        }
        for ([present, ..], value) in self.extents.iter_mut().zip(yoke) {
            if let Some(value) = value {
                present.add(value);
            }
        }
    }

    /// Compares the readback; returns whether writing has been unconfirmed for
    /// too long.
    pub(crate) fn is_overdue(&mut self, now: Time, link: &SharedState) -> bool {
        if let Some(newest) = self.agreement(now, link) {
            self.confirmed = newest;
        }
        now.since(self.confirmed) > CONFIRMED_WITHIN
    }

    /// Whether another program writes the yoke, too.
    pub(crate) fn is_contested(&mut self, now: Time, link: &SharedState) -> bool {
        let overridden = self
            .recent(Quantity::OverrideJoystick, now, link)
            .is_some_and(|(value, _)| value >= 0.5);
        let (mut elsewhere, mut stands, mut moved) = (false, false, false);
        let extents = self.extents;
        for ((index, axis), put) in YOKE.into_iter().enumerate().zip(extents) {
            let Some((value, at)) = self.recent(axis, now, link) else {
                continue;
            };
            let read_back = self.written.recognise(index, value, at);
            if let ReadBack::Own(age) = read_back {
                self.round_trip.add(now, age);
            }
            let Some(ours) = self.ours.get_mut(index) else {
                continue;
            };
            let is_there = ours.is_some_and(|ours| (value - ours).abs() <= STILL);
            moved |= !is_there;
            let is_recent = match read_back {
                ReadBack::Unknown => true,
                ReadBack::Own(age) => age.least <= CONFIRMED_WITHIN,
                ReadBack::Foreign => false,
            };
            if is_recent && Extent::of(put).holds(value) {
                *ours = Some(value);
            } else if is_there {
                stands = true;
            } else if is_recent || read_back == ReadBack::Foreign {
                elsewhere = true;
            }
        }
        // What is written may pass where the yoke stands.
        stands |= self.cut.holds() && !moved;
        self.cut.step(now, overridden && stands && !elsewhere);
        if overridden && elsewhere {
            self.moved_by_another = now;
        }
        let lately = !self.moved_by_another.is_never() && now.since(self.moved_by_another) < LATELY;
        self.contested.step(now, lately)
    }

    /// From writing to reading back, in the last second that has passed; zero while
    /// nothing is recognised.
    pub(crate) const fn round_trip(&self) -> Duration {
        self.round_trip.shown()
    }

    /// By how much what is read is too old to fly by; zero if it is not.
    pub(crate) fn too_late(&self) -> Duration {
        self.round_trip.too_late()
    }

    /// Whether the yoke stands still where it was put before: what is written does
    /// not arrive.
    pub(crate) const fn is_cut(&self) -> bool {
        self.cut.holds()
    }

    /// The latest readback of a quantity, and its time.
    fn recent(&self, quantity: Quantity, now: Time, link: &SharedState) -> Option<(f32, Time)> {
        link.read_back
            .shown(quantity)
            .filter(|(_, at)| *at > self.began && now.since(*at) <= LATELY)
    }

    /// The time of the latest readback, if there is one and all of them agree.
    fn agreement(&self, now: Time, link: &SharedState) -> Option<Time> {
        let mut newest = None;
        for quantity in OVERRIDES {
            if let Some((value, at)) = self.recent(quantity, now, link) {
                if value < 0.5 {
                    return None;
                }
                newest = newest.max(Some(at));
            }
        }
        for (quantity, put) in YOKE.into_iter().zip(self.extents) {
            if let Some((value, at)) = self.recent(quantity, now, link) {
                if !Extent::of(put).holds(value) {
                    return None;
                }
                newest = newest.max(Some(at));
            }
        }
        newest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TICK: Duration = Duration::from_millis(25);

    /// Writes a moving elevator for `ticks` ticks; the simulator's readback is
    /// `readback` applied to what was written 4 ticks earlier.
    fn overdue_after(ticks: u32, readback: impl Fn(f32) -> Option<[f32; 3]>) -> Vec<bool> {
        let link = SharedState::new(None);
        let mut now = Time::from_nanos(1_000_000_000);
        let mut confirmation = Confirmation::begin(now);
        let mut written = vec![0.0; 4];
        (0..ticks)
            .map(|tick| {
                now = now + TICK;
                if let Some([joystick, throttles, pitch]) = readback(written[tick as usize]) {
                    link.read_back
                        .show(Quantity::OverrideJoystick, f64::from(joystick), now);
                    link.read_back
                        .show(Quantity::OverrideThrottles, f64::from(throttles), now);
                    link.read_back
                        .show(Quantity::YokePitch, f64::from(pitch), now);
                }
                let elevator = (tick as f32 * 0.1).sin();
                written.push(elevator);
                confirmation.wrote(now, [Some(elevator), Some(0.0), Some(0.0)]);
                confirmation.is_overdue(now, &link)
            })
            .collect()
    }

    #[test]
    fn a_delayed_readback_is_confirmed() {
        let overdue = overdue_after(400, |written| Some([1.0, 1.0, written]));
        assert!(!overdue.contains(&true));
    }

    #[test]
    fn no_readback_is_overdue_after_a_second_and_not_before() {
        let overdue = overdue_after(60, |_| None);
        assert_eq!(overdue.iter().position(|overdue| *overdue), Some(40));
    }

    #[test]
    fn an_override_that_stays_off_is_not_confirmed() {
        assert_eq!(
            overdue_after(60, |v| Some([0.0, 1.0, v])).last(),
            Some(&true)
        );
        assert_eq!(
            overdue_after(60, |v| Some([1.0, 0.0, v])).last(),
            Some(&true)
        );
    }

    #[test]
    fn a_yoke_held_by_another_program_is_not_confirmed() {
        assert_eq!(
            overdue_after(400, |_| Some([1.0, 1.0, 1.5])).last(),
            Some(&true)
        );
    }

    /// Whether another program is found to write the yoke, at the end of ticks
    /// in which the yoke is read back as `readback` of the tick's number and of
    /// what was written.
    fn contested(ticks: u32, override_joystick: f64, readback: impl Fn(u32, f32) -> f32) -> bool {
        let link = SharedState::new(None);
        let mut now = Time::from_nanos(1_000_000_000);
        let mut confirmation = Confirmation::begin(now);
        let mut contested = false;
        for tick in 0..ticks {
            now = now + TICK;
            let elevator = (f64::from(tick) * 0.1).sin() as f32 * 0.2;
            confirmation.wrote(now, [Some(elevator), Some(0.0), Some(0.0)]);
            link.read_back
                .show(Quantity::OverrideJoystick, override_joystick, now);
            link.read_back.show(
                Quantity::YokePitch,
                f64::from(readback(tick, elevator)),
                now,
            );
            contested = confirmation.is_contested(now, &link);
        }
        contested
    }

    #[test]
    fn a_program_that_writes_the_yoke_now_and_then_is_found() {
        // Every fifth frame is the other's: 8 a second.
        assert!(contested(100, 1.0, |tick, ours| if tick % 5 == 0 {
            0.7
        } else {
            ours
        }));
        assert!(contested(100, 1.0, |_, _| 0.7));
        // Within what was written, but not written.
        assert!(contested(400, 1.0, |tick, ours| if tick % 3 == 0 {
            0.1234
        } else {
            ours
        }));
    }

    /// Up to 1 s each way, and a network that lets through a readback every 0.4 s.
    #[test]
    fn a_slow_or_lossy_network_is_not_another_program() {
        let written = |tick: u32| (f64::from(tick) * 0.1).sin() as f32 * 0.2;
        let delayed = |ticks: u32| move |tick: u32, _| written(tick.saturating_sub(ticks));
        assert!(!contested(400, 1.0, delayed(32)));
        assert!(!contested(400, 1.0, delayed(38)));
        assert!(!contested(400, 1.0, delayed(80)));
        let link = SharedState::new(None);
        let mut now = Time::from_nanos(1_000_000_000);
        let mut confirmation = Confirmation::begin(now);
        for tick in 0..400 {
            now = now + TICK;
            confirmation.wrote(now, [Some(written(tick)), Some(0.0), Some(0.0)]);
            if tick % 16 == 0 {
                link.read_back.show(Quantity::OverrideJoystick, 1.0, now);
                let shown = written(tick.saturating_sub(30));
                link.read_back.show(Quantity::YokePitch, shown.into(), now);
            }
            assert!(!confirmation.is_contested(now, &link), "tick {tick}");
        }
    }

    /// From 2.5 s on nothing arrives any more, of small movements.
    #[test]
    fn a_yoke_that_stays_where_it_was_put_is_a_cut_link_and_not_another_program() {
        let written = |tick: u32| (f64::from(tick) * 0.1).sin() as f32 * 0.01;
        let link = SharedState::new(None);
        let mut now = Time::from_nanos(1_000_000_000);
        let mut confirmation = Confirmation::begin(now);
        let mut cut = Vec::new();
        for tick in 0..800 {
            now = now + TICK;
            confirmation.wrote(now, [Some(written(tick)), Some(0.0), Some(0.0)]);
            link.read_back.show(Quantity::OverrideJoystick, 1.0, now);
            let shown = match tick {
                0..700 => written(tick.saturating_sub(4).min(100)),
                _ => 0.7,
            };
            link.read_back.show(Quantity::YokePitch, shown.into(), now);
            let contested = confirmation.is_contested(now, &link);
            // Another program that moves it then is found.
            assert_eq!(contested, tick >= 700 + 60, "tick {tick}");
            cut.push(confirmation.is_cut());
        }
        // A second until the last value is too old, and one and a half; meanwhile
        // what is written passes where the yoke stands.
        let first = cut.iter().position(|cut| *cut).unwrap();
        assert!((100 + 100..100 + 140).contains(&first), "{first}");
        assert!(cut[first..700].iter().all(|cut| *cut));
        assert!(!cut[720]);
    }

    #[test]
    fn neither_a_dead_link_nor_a_burst_of_old_values_is_another_program() {
        // Input switched off: the override is not set either.
        assert!(!contested(400, 0.0, |_, _| 0.7));
        // A second of old values after a freeze.
        assert!(!contested(60, 1.0, |tick, ours| if tick < 40 {
            0.7
        } else {
            ours
        }));
        assert!(!contested(400, 1.0, |_, ours| ours));
        // A simulator that stores hundredths shows nothing as written.
        assert!(!contested(400, 1.0, |_, ours| (ours * 100.0).round() / 100.0));
    }
}
