//! The wheels on the ground where neither a take-off nor a landing is flown.

use super::{Autopilot, runway};
use fcc_guidance::Mode;
use fcc_guidance::route::RunwayReason;

/// A range finder that shows more than this above what it shows on the wheels contradicts
/// their switch, m.
const CLEAR_M: f64 = 1.0;
/// It climbs off the ground by this much, m: the loops would push it onto the ground with ever
/// more elevator, and where that ends it would dive.
const CLIMBS_OFF_M: f64 = 10.0;
/// At most to this height above where it first touched, m: ground that rises, or a switch that
/// is wrong.
const MOST_CLIMB_M: f64 = 30.0;

/// What may come and go many times a second is told at most once in this time, s.
const TOLD_EVERY_S: f64 = 10.0;

/// For how long something is not told again, s.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Told(f64);

impl Told {
    pub(super) const fn pass(&mut self, dt_s: f64) {
        self.0 -= dt_s;
    }

    /// Whether it is told now.
    pub(super) fn is_due(&mut self) -> bool {
        let is_due = self.0 <= 0.0;
        if is_due {
            self.0 = TOLD_EVERY_S;
        }
        is_due
    }
}

/// Where the wheels touched first, m, since they were off the ground for long, and for how long
/// they are, s.
#[derive(Clone, Copy, Debug, Default)]
struct Touched {
    first_m: Option<f64>,
    clear_s: f64,
}

impl Touched {
    /// The altitude to climb to, m, of an aircraft that touches the ground at this one.
    fn off_ground_m(&mut self, altitude_m: f64) -> f64 {
        self.clear_s = 0.0;
        let first_m = *self.first_m.get_or_insert(altitude_m);
        (altitude_m + CLIMBS_OFF_M).min(first_m + MOST_CLIMB_M)
    }

    fn is_clear_for(&mut self, dt_s: f64) {
        self.clear_s += dt_s;
        if self.clear_s > TOLD_EVERY_S {
            self.first_m = None;
        }
    }
}

/// What is told once.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ToldOnce {
    /// Whether the wheels were off the ground, since engaging or since that was told.
    has_flown: bool,
    touched: Touched,
    /// Whether the end of the plan is told.
    pub(super) end: bool,
    /// That the wheels touch, and that the range finder is wrong on them.
    pub(super) touch: Told,
    pub(super) range: Told,
}

impl Autopilot {
    /// An aircraft that is on its wheels, and is not to be, climbs; that it has flown before is
    /// announced. Where nothing measures the weight on the wheels nothing is known of it.
    pub(super) fn watch_ground_contact(&mut self) {
        let Some(on_wheels) = self.estimator.ground.on_wheels() else {
            return;
        };
        let is_clear = self.estimator.ground.here().and_then(|here| here.height_m);
        let on_wheels_m = self.config.route.runway.height_on_wheels_m;
        let is_clear = is_clear.is_some_and(|height_m| height_m > on_wheels_m + CLEAR_M);
        if !on_wheels || is_clear {
            self.supervisor.told_once.has_flown = true;
            self.supervisor
                .told_once
                .touched
                .is_clear_for(self.intake.clock.passed_s());
            return;
        }
        let is_expected =
            self.guidance.runway().is_some() || self.guidance.mode.mode() == Mode::Glide;
        if !is_expected {
            let altitude_m = self.estimator.estimate().altitude_m;
            let off_ground_m = self.supervisor.told_once.touched.off_ground_m(altitude_m);
            self.guidance.targets.altitude_m = self.guidance.targets.altitude_m.max(off_ground_m);
            if self.supervisor.told_once.has_flown && self.supervisor.told_once.touch.is_due() {
                self.journal.add(runway::notice(RunwayReason::Touched));
            }
        }
        self.supervisor.told_once.has_flown = false;
    }
}

#[cfg(test)]
mod tests {
    use super::{Told, Touched};

    /// A switch that flickers at 20 Hz for 25 s is told at 0, 10 and 20 s.
    #[test]
    fn what_flickers_is_told_once_in_ten_seconds() {
        let mut told = Told::default();
        let is_told = |told: &mut Told| {
            told.pass(0.05);
            told.is_due()
        };
        assert_eq!((0..500).filter(|_| is_told(&mut told)).count(), 3);
    }

    /// A switch that flickers for two minutes at whatever height leads 100 ft up at most.
    #[test]
    fn a_wheel_switch_that_is_wrong_leads_no_higher() {
        let mut touched = Touched::default();
        let mut altitude_m = 914.4;
        for tick in 0..4_800 {
            if tick % 2 == 0 {
                altitude_m = touched.off_ground_m(altitude_m);
            } else {
                touched.is_clear_for(0.025);
            }
        }
        assert!(
            (914.4..=914.4 + 30.48).contains(&altitude_m),
            "{altitude_m}"
        );
    }
}
