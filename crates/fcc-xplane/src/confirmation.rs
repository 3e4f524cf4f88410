//! Whether what is written takes effect.
//!
//! X-Plane acknowledges nothing, and its output flows even where its input is
//! switched off or a firewall drops it. So the overrides and the yoke are read
//! back while they are written: the writing is confirmed as long as everything
//! that came back lately agrees with what was sent lately. The throttle itself
//! is not compared, since the engine's own model may change it; its override
//! is.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::link::SharedState;
use crate::quantity::Quantity;

/// Writing may go unconfirmed for so long.
pub(crate) const CONFIRMED_WITHIN: Duration = Duration::from_secs(1);
/// What came back in this time counts.
const LATELY: Duration = Duration::from_millis(500);
/// How far what comes back may lie outside what was sent lately: the rounding
/// of a simulator that keeps the ratio in another form.
const TOLERANCE: f32 = 0.02;

const YOKE: [Quantity; 3] = [
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
];
const OVERRIDES: [Quantity; 2] = [Quantity::OverrideJoystick, Quantity::OverrideThrottles];

/// The least and the greatest that was written in some time.
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

    fn with(self, other: Self) -> Self {
        Self {
            least: self.least.min(other.least),
            greatest: self.greatest.max(other.greatest),
        }
    }

    fn holds(self, value: f32) -> bool {
        (self.least - TOLERANCE..=self.greatest + TOLERANCE).contains(&value)
    }
}

/// Compares what is written with what comes back.
#[derive(Clone, Debug)]
pub(crate) struct Confirmation {
    /// When control was taken.
    began: Time,
    confirmed: Time,
    /// What was written to each axis in the present half second and in the one
    /// before: what comes back is older by the way there and back.
    extents: [[Extent; 2]; 3],
    turned: Time,
}

impl Confirmation {
    /// Control is taken.
    pub(crate) const fn begin(now: Time) -> Self {
        Self {
            began: now,
            confirmed: now,
            extents: [[Extent::EMPTY; 2]; 3],
            turned: now,
        }
    }

    /// This was written to elevator, aileron and rudder.
    pub(crate) fn wrote(&mut self, now: Time, yoke: [Option<f32>; 3]) {
        if now.since(self.turned) >= LATELY {
            self.turned = now;
            for [present, before] in &mut self.extents {
                *before = *present;
                *present = Extent::EMPTY;
            }
        }
        for ([present, _], value) in self.extents.iter_mut().zip(yoke) {
            if let Some(value) = value {
                present.add(value);
            }
        }
    }

    /// Looks at what came back; whether the writing has gone unconfirmed for
    /// too long.
    pub(crate) fn is_overdue(&mut self, now: Time, link: &SharedState) -> bool {
        if let Some(newest) = self.agreement(now, link) {
            self.confirmed = newest;
        }
        now.since(self.confirmed) > CONFIRMED_WITHIN
    }

    /// When the latest came back, if something did and all of it agrees.
    fn agreement(&self, now: Time, link: &SharedState) -> Option<Time> {
        let lately = |quantity| {
            link.shown(quantity)
                .filter(|(_, at)| *at > self.began && now.since(*at) <= LATELY)
        };
        let mut newest = None;
        for quantity in OVERRIDES {
            if let Some((value, at)) = lately(quantity) {
                if value < 0.5 {
                    return None;
                }
                newest = newest.max(Some(at));
            }
        }
        for (quantity, [present, before]) in YOKE.into_iter().zip(self.extents) {
            if let Some((value, at)) = lately(quantity) {
                if !present.with(before).holds(value) {
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

    /// Writes a moving elevator for so many ticks while the simulator shows
    /// what `shows` makes of what was written 4 ticks ago.
    fn overdue_after(ticks: u32, shows: impl Fn(f32) -> Option<[f32; 3]>) -> Vec<bool> {
        let link = SharedState::new(None);
        let mut now = Time::from_nanos(1_000_000_000);
        let mut confirmation = Confirmation::begin(now);
        let mut written = vec![0.0; 4];
        (0..ticks)
            .map(|tick| {
                now = now + TICK;
                if let Some([joystick, throttles, pitch]) = shows(written[tick as usize]) {
                    link.show(Quantity::OverrideJoystick, f64::from(joystick), now);
                    link.show(Quantity::OverrideThrottles, f64::from(throttles), now);
                    link.show(Quantity::YokePitch, f64::from(pitch), now);
                }
                let elevator = (tick as f32 * 0.1).sin();
                written.push(elevator);
                confirmation.wrote(now, [Some(elevator), Some(0.0), Some(0.0)]);
                confirmation.is_overdue(now, &link)
            })
            .collect()
    }

    #[test]
    fn what_follows_with_a_delay_is_confirmed() {
        let overdue = overdue_after(400, |written| Some([1.0, 1.0, written]));
        assert!(!overdue.contains(&true));
    }

    #[test]
    fn nothing_back_is_overdue_after_a_second_and_not_before() {
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
    fn a_yoke_that_somebody_else_holds_is_not_confirmed() {
        assert_eq!(
            overdue_after(400, |_| Some([1.0, 1.0, 1.5])).last(),
            Some(&true)
        );
    }
}
