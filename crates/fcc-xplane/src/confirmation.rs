//! Checks that the written controls take effect.
//!
//! X-Plane sends no acknowledgement, and it sends data even if its input is
//! switched off or blocked by a firewall. So the overrides and the yoke are
//! read back while they are written. Writing is confirmed as long as every
//! recent readback agrees with what was recently sent. The throttle itself is
//! not compared, since the engine model may change it, but its override is.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::link::SharedState;
use crate::quantity::Quantity;

/// The longest time for which writing may be unconfirmed.
pub(crate) const CONFIRMED_WITHIN: Duration = Duration::from_secs(1);
/// A readback counts as recent for this long.
const LATELY: Duration = Duration::from_millis(500);
/// How far a readback may lie outside the recently sent values: rounding, if
/// the simulator stores the ratio in another form.
const TOLERANCE: f32 = 0.02;

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
    /// Whether the overrides were never read back.
    awaits: bool,
}

impl Confirmation {
    /// Starts when control is taken.
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            began: now,
            confirmed: now,
            extents: [[Extent::EMPTY; 3]; 3],
            turned: now,
            awaits: true,
        }
    }

    /// Whether the overrides were never read back.
    pub(crate) const fn awaits_overrides(&self) -> bool {
        self.awaits
    }

    /// Waits until the overrides are read back for the first time.
    pub(crate) fn await_overrides(&mut self, now: Time, link: &SharedState) {
        self.awaits &= !OVERRIDES.into_iter().all(|quantity| {
            self.recent(quantity, now, link)
                .is_some_and(|(value, _)| value >= 0.5)
        });
    }

    /// Records what was written to elevator, aileron and rudder.
    pub(crate) fn wrote(&mut self, now: Time, yoke: [Option<f32>; 3]) {
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
