//! Whether the outputs reach the aircraft: where the plant measures its
//! controls, they move when the outputs do.

use core::time::Duration;

use super::Autopilot;
use fcc_core::flight::Surfaces;
use fcc_core::framework::Time;
use fcc_guidance::Mode;

/// A control that moves by less stands still.
const STILL: f64 = 1e-3;
/// An output that left what it was in the second before the controls stood still
/// by more than this was not followed. By more than the play of a servo.
const AWAY: f64 = 0.1;
/// For so long: longer than any servo and link is late.
const FOR_S: f64 = 1.5;
/// The controls may be late by this.
const LATE_S: f64 = 1.0;
/// What has not followed in as many ticks in a row, by moving or by being as near
/// as this to the outputs, is no measurement of the controls.
const FOLLOWED_IN: u8 = 120;
const NEAR: f64 = 0.02;

type Axes = [f64; 4];

const fn axes(surfaces: &Surfaces) -> Axes {
    [
        surfaces.throttle,
        surfaces.elevator,
        surfaces.aileron,
        surfaces.rudder,
    ]
}

fn differs(a: &Axes, b: &Axes, by: f64) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > by)
}

/// The least and the most of each output in a time.
#[derive(Clone, Copy, Debug)]
struct Range {
    least: Axes,
    most: Axes,
}

impl Range {
    const fn of(axes: &Axes) -> Self {
        Self {
            least: *axes,
            most: *axes,
        }
    }

    fn widen(&mut self, with: &Self) {
        for (least, with) in self.least.iter_mut().zip(&with.least) {
            *least = least.min(*with);
        }
        for (most, with) in self.most.iter_mut().zip(&with.most) {
            *most = most.max(*with);
        }
    }

    /// By how much the farthest of the outputs is outside.
    fn excess(&self, outputs: &Axes) -> f64 {
        let bounds = self.least.iter().zip(&self.most);
        outputs
            .iter()
            .zip(bounds)
            .fold(0.0, |most: f64, (output, (low, high))| {
                most.max(low - output).max(output - high)
            })
    }
}

/// Compares the measured controls with the outputs. Only movements are compared:
/// a plant that measures them with another scale, or late by less than a second,
/// moves them too; one that jams, or that another program writes, moves the
/// others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Following {
    /// Where the controls stand still, and the outputs in the second before.
    still: Option<(Axes, Range)>,
    /// The outputs in this half second and in the one before, and how much of
    /// this one has passed.
    recent: Option<[Range; 2]>,
    recent_s: f64,
    away_s: f64,
    /// In how many ticks in a row the controls followed, counted as far as needed.
    followed: u8,
    is_lost: bool,
}

impl Following {
    /// Compares the measured controls, if they are, with the outputs of the tick
    /// before, `passed_s` of the plant's time after the last; whether they do
    /// not follow.
    fn step(&mut self, measured: Option<Surfaces>, outputs: &Surfaces, passed_s: f64) -> bool {
        let Some(measured) = measured.map(|surfaces| axes(&surfaces)) else {
            *self = Self::default();
            return false;
        };
        let outputs = axes(outputs);
        let now = Range::of(&outputs);
        let recent = self.recent.get_or_insert([now; 2]);
        let [this, last] = recent;
        this.widen(&now);
        let mut second = *this;
        second.widen(last);
        self.recent_s += passed_s;
        if self.recent_s >= 0.5 * LATE_S {
            *last = *this;
            *this = now;
            self.recent_s = 0.0;
        }
        let moved = self
            .still
            .as_ref()
            .is_some_and(|(at, _)| differs(at, &measured, STILL));
        if self.followed < FOLLOWED_IN {
            let follows = moved || second.excess(&measured) < NEAR;
            self.followed = if follows { self.followed + 1 } else { 0 };
        }
        match &self.still {
            Some((_, before)) if !moved => {
                if self.followed >= FOLLOWED_IN && before.excess(&outputs) > AWAY {
                    self.away_s += passed_s;
                } else {
                    self.away_s = 0.0;
                }
                self.is_lost |= self.away_s > FOR_S;
            }
            _ => {
                self.still = Some((measured, second));
                self.away_s = 0.0;
                self.is_lost = false;
            }
        }
        self.is_lost
    }

    /// Whether the outputs do not reach the aircraft.
    pub(super) const fn is_lost(&self) -> bool {
        self.is_lost
    }
}

impl Autopilot {
    /// While the outputs do not reach the aircraft, takes the loops over at its
    /// measured controls, tick by tick: they do not integrate what has no
    /// effect.
    pub(super) fn take_over_unless_followed(&mut self, now: Time, max_age: Duration) {
        let measured = self.intake.accepted.surfaces.fresh(now, max_age);
        let is_flown =
            self.guidance.mode.mode() != Mode::None && !self.intake.withholds(&self.config, now);
        let measured = measured.filter(|_| is_flown);
        let passed_s = self.intake.clock.passed_s();
        if self
            .supervisor
            .following
            .step(measured, &self.loops.last, passed_s)
            && let Some(controls) = measured
        {
            self.take_over(&controls);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;

    fn aileron(aileron: f64) -> Surfaces {
        Surfaces {
            aileron,
            ..Surfaces::default()
        }
    }

    /// The aileron swings slowly by ±0.4, as in turns; the first tick in which
    /// it is not followed, s.
    fn lost_after_s(measured: impl Fn(f64, &dyn Fn(f64) -> f64) -> Option<f64>) -> Option<f64> {
        let mut following = Following::default();
        let output = |at_s: f64| 0.4 * libm::sin(at_s);
        (0..1_200).find_map(|n| {
            let at_s = f64::from(n) * DT_S;
            let controls = measured(at_s, &output).map(aileron);
            following
                .step(controls, &aileron(output(at_s)), DT_S)
                .then_some(at_s)
        })
    }

    #[test]
    fn controls_that_are_late_scaled_stepped_or_not_measured_follow() {
        assert_eq!(lost_after_s(|at_s, output| Some(output(at_s - 0.8))), None);
        assert_eq!(lost_after_s(|at_s, output| Some(0.3 * output(at_s))), None);
        let stepped =
            |at_s: f64, output: &dyn Fn(f64) -> f64| Some((50.0 * output(at_s)).round() / 50.0);
        assert_eq!(lost_after_s(stepped), None);
        assert_eq!(lost_after_s(|_, _| None), None);
        assert_eq!(lost_after_s(|_, _| Some(0.1)), None);
        // Another program's.
        assert_eq!(
            lost_after_s(|at_s, _| Some(0.2 * libm::sin(3.0 * at_s))),
            None
        );
    }

    #[test]
    fn controls_that_stand_still_do_not_follow() {
        let cut_s = 6.0;
        let lost_s = lost_after_s(|at_s, output| Some(output(at_s.min(cut_s)))).unwrap();
        // The output moves by 0.1 in 0.3 s, and 1.5 s pass.
        assert!(
            (cut_s + FOR_S..cut_s + FOR_S + 0.6).contains(&lost_s),
            "{lost_s}"
        );
    }

    #[test]
    fn controls_that_move_again_follow_at_once() {
        let mut following = Following::default();
        for n in 0..300 {
            let output = f64::from(n) * 0.002;
            let controls = aileron(output.min(0.3));
            following.step(Some(controls), &aileron(output), DT_S);
        }
        assert!(following.is_lost);
        assert!(!following.step(Some(aileron(0.302)), &aileron(0.302), DT_S));
    }
}
