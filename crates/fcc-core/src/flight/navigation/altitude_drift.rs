//! Whether the altimeter drifts or a satellite receiver: what the one has climbed in a minute
//! or two, held against the other.

use libm::fabs;

use super::drift_judge::{ClimbRates, DriftJudge};
use super::sample_tracker::is_current;
use crate::flight::Measurements;
use crate::framework::Time;

/// What is compared is as old as this at least, and twice as old at most, s.
const WINDOW_S: f64 = 60.0;
/// The altimeter drifts if it differs for this time, s, from the climb by the ground
/// velocity by more than this, m, and its step; and by this share of that climb: in air
/// 60 K colder than the standard a pressure altitude changes by a quarter more (ISO 2533).
const DRIFTS_AFTER_S: f64 = 5.0;
const DIFFERS_M: f64 = 15.0;
const TEMPERATURE_SHARE: f64 = 0.25;
/// The receiver's altitude agrees with its velocity if it differs from the altimeter's
/// by this share of that, at least; it is averaged over this time, s.
const ALTITUDE_SHARE: f64 = 0.5;
const AVERAGED_OVER_S: f64 = 10.0;
/// What a receiver measures.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(super) altitude_m: f64,
    pub(super) climb_rate_mps: f64,
}

impl Receiver {
    /// What it measures at `now`, if it does.
    pub(crate) fn of(measured: &Measurements, now: Time) -> Option<Self> {
        let (position, velocity) = (&measured.position, &measured.velocity);
        (is_current(position, now) && is_current(velocity, now)).then_some(Self {
            altitude_m: position.value.altitude_m,
            climb_rate_mps: -velocity.value.down_mps,
        })
    }
}

/// Since the beginning of a window.
#[derive(Clone, Copy, Debug)]
struct Window {
    altimeter_m: f64,
    /// The altimeter above the receiver's altitude, averaged.
    above_m: f64,
    /// By the ground velocity.
    climbed_m: f64,
    lasted_s: f64,
}

impl Window {
    /// The altimeter's altitude without what it has drifted, m.
    fn right_m(&self) -> f64 {
        self.altimeter_m + self.climbed_m
    }
}

/// What has drifted.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Drifted {
    /// The altimeter; the right altitude, m.
    Altimeter(f64),
    /// The receiver, in altitude and vertical velocity.
    Receiver,
}

/// Two quantities of the receiver have to agree that one of the two drifts: a fix that
/// jumps has an altitude only, and a wrong vertical velocity has no altitude. Which of them
/// it is, a [`DriftJudge`] tells; where nothing speaks for the altimeter it is that.
#[derive(Clone, Copy, Debug)]
pub(super) struct AltitudeDrift {
    above_m: Option<f64>,
    older: Option<Window>,
    younger: Option<Window>,
    beyond_s: f64,
    judge: DriftJudge,
    receiver_is_doubted: bool,
}

impl AltitudeDrift {
    pub(super) const fn new() -> Self {
        Self {
            above_m: None,
            older: None,
            younger: None,
            beyond_s: 0.0,
            judge: DriftJudge::new(),
            receiver_is_doubted: false,
        }
    }

    /// Whether the receiver has drifted, and does not agree with the altimeter again.
    pub(super) const fn doubts_receiver(&self) -> bool {
        self.receiver_is_doubted
    }

    /// The receiver's climb rate less the altimeter's, m/s.
    pub(super) fn receiver_more_mps(&self) -> f64 {
        self.judge.difference_mps()
    }

    /// What was climbed is counted anew from here on.
    pub(super) const fn restart(&mut self) {
        (self.older, self.younger, self.above_m) = (None, None, None);
        self.beyond_s = 0.0;
    }

    /// `dt_s` seconds pass, with the altimeter's altitude and the step of a coarse one, m.
    /// What has drifted, once it has.
    pub(super) fn step(
        &mut self,
        altimeter: Option<(f64, f64)>,
        receiver: Option<Receiver>,
        rates: ClimbRates,
        dt_s: f64,
    ) -> Option<Drifted> {
        let Some(((altimeter_m, step_m), receiver)) = altimeter.zip(receiver) else {
            self.restart();
            return None;
        };
        self.judge.step(receiver.climb_rate_mps, rates, dt_s);
        self.receiver_is_doubted &= !self.judge.they_agree();
        let now_above_m = altimeter_m - receiver.altitude_m;
        let above_m = self.above_m.map_or(now_above_m, |was_m| {
            was_m + (now_above_m - was_m) * (dt_s / AVERAGED_OVER_S).min(1.0)
        });
        self.above_m = Some(above_m);
        let begun = Window {
            altimeter_m,
            above_m,
            climbed_m: 0.0,
            lasted_s: 0.0,
        };
        let passed = |window: Option<Window>| {
            window.map_or(begun, |window| Window {
                climbed_m: window.climbed_m + receiver.climb_rate_mps * dt_s,
                lasted_s: window.lasted_s + dt_s,
                ..window
            })
        };
        let (mut older, mut younger) = (passed(self.older), passed(self.younger));
        if younger.lasted_s >= WINDOW_S {
            (older, younger) = (younger, begun);
        }
        (self.older, self.younger) = (Some(older), Some(younger));
        let off_m = altimeter_m - older.right_m();
        let by_altitude_m = (above_m - older.above_m) * off_m.signum();
        let limit_m = DIFFERS_M + step_m + TEMPERATURE_SHARE * fabs(older.climbed_m);
        let drifts = fabs(off_m) > limit_m && by_altitude_m > ALTITUDE_SHARE * fabs(off_m);
        self.beyond_s = if drifts { self.beyond_s + dt_s } else { 0.0 };
        (self.beyond_s > DRIFTS_AFTER_S).then(|| {
            self.restart();
            self.receiver_is_doubted = self.judge.is_for_altimeter();
            if self.receiver_is_doubted {
                Drifted::Receiver
            } else {
                Drifted::Altimeter(older.right_m())
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;

    /// Climbs for five minutes; what has drifted, the true altitude and when that is, s. Each
    /// measure is made of the time, and of the true altitude or climb rate.
    fn fly(
        climbs_mps: f64,
        altimeter_m: impl Fn(f64, f64) -> f64,
        receiver_m: impl Fn(f64, f64) -> f64,
        receiver_mps: impl Fn(f64) -> f64,
        path_mps: Option<&dyn Fn(f64) -> f64>,
    ) -> Option<(Drifted, f64, f64)> {
        let mut drift = AltitudeDrift::new();
        let mut before_m = altimeter_m(0.0, 500.0);
        (0..12_000).find_map(|tick| {
            let t_s = f64::from(tick) * DT_S;
            let true_m = 500.0 + climbs_mps * t_s;
            let receiver = Receiver {
                altitude_m: receiver_m(t_s, true_m),
                climb_rate_mps: receiver_mps(climbs_mps),
            };
            let altimeter_m = altimeter_m(t_s, true_m);
            let rates = ClimbRates {
                altimeter_mps: (altimeter_m - before_m) / DT_S,
                path_mps: path_mps.map(|path_mps| climbs_mps + path_mps(t_s)),
                alone: None,
            };
            before_m = altimeter_m;
            let found = drift.step(Some((altimeter_m, 0.0)), Some(receiver), rates, DT_S);
            assert_eq!(drift.doubts_receiver(), found == Some(Drifted::Receiver));
            found.map(|drifted| (drifted, true_m, t_s))
        })
    }

    fn right(_: f64, true_m: f64) -> f64 {
        true_m
    }

    /// A receiver whose altitude wanders by 8 m in a minute.
    fn wanders_m(t_s: f64, true_m: f64) -> f64 {
        true_m + 8.0 * libm::sin(0.05 * t_s)
    }

    /// By pitch and lift, in thermals of 1.5 m/s every 20 s.
    fn thermals_mps(t_s: f64) -> f64 {
        1.5 * libm::sin(0.31 * t_s)
    }

    #[test]
    fn a_drift_that_no_copy_shows_is_found_before_it_is_forty_metres() {
        let paths: [Option<&dyn Fn(f64) -> f64>; 2] = [None, Some(&thermals_mps)];
        for (rate_mps, path) in [0.3, 0.5, -0.5, 1.0, -1.0]
            .into_iter()
            .flat_map(|rate_mps| paths.map(|path| (rate_mps, path)))
        {
            let drifts = |t_s: f64, true_m: f64| true_m + rate_mps * t_s;
            let (drifted, true_m, t_s) = fly(0.0, drifts, wanders_m, |mps| mps, path).unwrap();
            assert!(fabs(rate_mps) * t_s < 40.0, "{rate_mps}: {t_s}");
            let Drifted::Altimeter(right_m) = drifted else {
                panic!("{rate_mps}: the receiver is right")
            };
            // What it drifted before the window is not known.
            assert!(fabs(right_m - true_m) < 20.0, "{right_m} {true_m}");
        }
    }

    #[test]
    fn a_receiver_that_drifts_is_the_one_that_pitch_and_lift_contradict() {
        for rate_mps in [0.5, -0.5, 1.0, -1.0, 3.0, -3.0] {
            let receiver_m = |t_s: f64, true_m: f64| true_m + rate_mps * t_s;
            let path = Some(&thermals_mps as &dyn Fn(f64) -> f64);
            let found = fly(0.0, right, receiver_m, |mps| mps + rate_mps, path);
            let (drifted, _, t_s) = found.unwrap();
            assert_eq!(drifted, Drifted::Receiver, "{rate_mps}");
            // The altitude that is averaged over 10 s has to follow.
            assert!(t_s < 15.0 + 40.0 / fabs(rate_mps), "{rate_mps}: {t_s}");
        }
    }

    /// In air that is 60 K colder, with a receiver that jumps, with a wrong velocity.
    #[test]
    fn neither_cold_air_nor_one_wrong_quantity_of_the_receiver_is_a_drift() {
        let jumps = |t_s: f64, true_m: f64| true_m + if t_s > 100.0 { 80.0 } else { 0.0 };
        for climbs_mps in [-5.0, 0.0, 2.0, 5.0] {
            let cold = |_: f64, true_m: f64| 1.25 * true_m;
            assert!(fly(climbs_mps, cold, wanders_m, |mps| mps, None).is_none());
            assert!(fly(climbs_mps, right, wanders_m, |mps| mps, None).is_none());
            assert!(fly(climbs_mps, right, jumps, |mps| mps, None).is_none());
            assert!(fly(climbs_mps, right, wanders_m, |mps| mps + 1.0, None).is_none());
        }
    }
}
