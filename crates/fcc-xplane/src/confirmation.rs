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
use crate::round_trip::{RoundTrip, TOO_LONG};
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
    /// What was last read of each axis.
    shown: [Option<f32>; 3],
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
            shown: [None; 3],
            ours: [None; 3],
            cut: Lasting::new(CONTESTED_AFTER, LATELY),
            moved_by_another: Time::NEVER,
            contested: Lasting::new(CONTESTED_AFTER, CONTESTED_UNTIL),
            round_trip: RoundTrip::begin(now),
            awaited: Some((Duration::ZERO, now)),
        }
    }

    /// Whether the overrides were never read back.
    pub(crate) const fn awaits_overrides(&self) -> bool {
        self.awaited.is_some()
    }

    /// Whether they have been awaited for longer than a round trip over which an aircraft is
    /// flown: what is written does not arrive, or too late to answer what is read.
    pub(crate) fn awaits_too_long(&self) -> bool {
        self.awaited.is_some_and(|(waited, _)| waited > TOO_LONG)
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
        let are_there = OVERRIDES.into_iter().all(|quantity| {
            self.recent(quantity, now, link)
                .is_some_and(|(value, _)| value >= 0.5)
        });
        self.awaited = if are_there {
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
            if let (ReadBack::Own(ago), Some(shown)) = (read_back, self.shown.get_mut(index)) {
                let changes = shown.is_some_and(|shown| (value - shown).abs() > STILL);
                *shown = Some(value);
                self.round_trip.add(now, ago, changes);
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
mod tests;
