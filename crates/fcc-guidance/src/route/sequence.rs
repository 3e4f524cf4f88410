//! The order of a route's steps: what is flown next, and what takes effect before.

use super::OverGround;
use super::back::BACK;
use super::step::{FOR_EVER, JUMPS, Route, Step};
use crate::path::{LocalPlane, length};

/// What is flown.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Steps {
    /// A plan.
    Plan(Route<'static>),
    /// One step that was commanded.
    One(Step),
}

/// The steps, and how often their jumps were taken.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Sequence {
    steps: Steps,
    jumped: [u16; JUMPS],
    waiting: Option<Waiting>,
    /// What is flown in place of a [`Step::LandBack`], which is the last one, and its
    /// index.
    back: Option<(usize, [Step; BACK])>,
}

/// Steps that take effect later.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Waiting {
    /// The first of them.
    from: usize,
    /// Until this much time has passed, s, or the next place is so near, m.
    seconds: Option<f64>,
    distance_m: f64,
}

impl Sequence {
    pub(super) const fn new(steps: Steps) -> Self {
        Self {
            steps,
            jumped: [0; JUMPS],
            waiting: None,
            back: None,
        }
    }

    /// Flies these steps in place of the last one; returns the first of them.
    pub(super) const fn land_back(&mut self, index: usize, steps: &[Step; BACK]) -> Step {
        self.back = Some((index, *steps));
        let [first, ..] = *steps;
        first
    }

    pub(super) const fn lands_back(&self) -> bool {
        self.back.is_some()
    }

    /// The step of the route that the one with an index belongs to, and whether it is the
    /// end of that.
    pub(super) fn planned(&self, index: usize) -> (usize, bool) {
        match self.back {
            Some((first, _)) if index >= first => (first, index + 1 == first + BACK),
            _ => (index, true),
        }
    }

    /// The route; of one step that was commanded, an empty one.
    pub(super) fn route(&self) -> Route<'static> {
        match self.steps {
            Steps::Plan(route) => route,
            Steps::One(_) => Route::default(),
        }
    }

    fn step(&self, index: usize) -> Option<&Step> {
        if let Some((first, steps)) = &self.back
            && let Some(number) = index.checked_sub(*first)
        {
            return steps.get(number);
        }
        match &self.steps {
            Steps::Plan(route) => route.step(index),
            Steps::One(step) => (index == 0).then_some(step),
        }
    }

    fn len(&self) -> usize {
        match &self.steps {
            Steps::Plan(route) => route.steps.len(),
            Steps::One(_) => 1,
        }
    }

    /// The next step that is flown, from an index on, with its index; what only takes
    /// effect is given to `effect`. None at the end.
    pub(super) fn next(
        &mut self,
        from: usize,
        effect: &mut impl FnMut(&Step),
    ) -> Option<(usize, Step)> {
        self.end_waiting(effect);
        let mut index = from;
        // Jumps that never fly anything are refused when a plan is checked.
        for _ in 0..2 * self.len() + JUMPS {
            let step = *self.step(index)?;
            match step {
                step if step.is_flown() => return Some((index, step)),
                Step::Jump { to, times, counter } => {
                    self.end_waiting(effect);
                    index = if self.is_taken(times, counter) {
                        usize::from(to)
                    } else {
                        index + 1
                    };
                    continue;
                }
                Step::Delay(seconds) if self.waiting.is_none() => {
                    self.waiting = Some(Waiting {
                        from: index + 1,
                        seconds: Some(seconds),
                        distance_m: 0.0,
                    });
                }
                Step::UntilDistance(distance_m) if self.waiting.is_none() => {
                    self.waiting = Some(Waiting {
                        from: index + 1,
                        seconds: None,
                        distance_m,
                    });
                }
                _ if self.waiting.is_none() => effect(&step),
                _ => {}
            }
            index += 1;
        }
        None
    }

    /// Where a landing is begun, or begun again: its sequence's begin, or the place before
    /// it; none if there is no place.
    pub(super) fn before_landing(&self, land: usize) -> Option<usize> {
        if let Some((first, _)) = self.back {
            return Some(first);
        }
        let (place, _) = self.place_before(land)?;
        let is_start = |index: &usize| matches!(self.step(*index), Some(Step::LandStart));
        Some((0..place).rev().find(is_start).unwrap_or(place))
    }

    /// The waypoint from which a landing's leg leads; none if a circle is before it, from
    /// where it leads is left.
    pub(super) fn approach_from(&self, land: usize) -> Option<LocalPlane> {
        self.place_before(land)?.1
    }

    /// The last place before a step: its index, and where it is, if that is a waypoint.
    fn place_before(&self, index: usize) -> Option<(usize, Option<LocalPlane>)> {
        (0..index).rev().find_map(|before| match self.step(before) {
            Some(Step::Waypoint { at, .. }) => Some((before, Some(*at))),
            Some(Step::Loiter { .. }) => Some((before, None)),
            _ => None,
        })
    }

    /// The same without going on.
    pub(super) fn peek(&self, from: usize) -> Option<Step> {
        let mut scratch = *self;
        scratch.next(from, &mut |_| {}).map(|(_, step)| step)
    }

    /// `dt_s` seconds pass, and the place is so far away, m.
    pub(super) fn wait(&mut self, dt_s: f64, to_go_m: f64, effect: &mut impl FnMut(&Step)) {
        let Some(waiting) = &mut self.waiting else {
            return;
        };
        let is_over = match &mut waiting.seconds {
            Some(seconds) => {
                *seconds -= dt_s;
                *seconds <= 0.0
            }
            None => to_go_m <= waiting.distance_m,
        };
        if !is_over {
            return;
        }
        let from = waiting.from;
        self.waiting = None;
        for index in from..self.len() {
            match self.step(index).copied() {
                Some(Step::Delay(seconds)) => {
                    self.waiting = Some(Waiting {
                        from: index + 1,
                        seconds: Some(seconds),
                        distance_m: 0.0,
                    });
                    return;
                }
                Some(Step::UntilDistance(distance_m)) => {
                    self.waiting = Some(Waiting {
                        from: index + 1,
                        seconds: None,
                        distance_m,
                    });
                    return;
                }
                Some(step) if !step.is_flown() && !matches!(step, Step::Jump { .. }) => {
                    effect(&step);
                }
                _ => return,
            }
        }
    }

    /// What waits takes effect now: the place is reached.
    fn end_waiting(&mut self, effect: &mut impl FnMut(&Step)) {
        // Each of them may wait again.
        for _ in 0..self.len() {
            if self.waiting.is_none() {
                return;
            }
            self.wait(f64::INFINITY, f64::NEG_INFINITY, effect);
        }
    }

    /// Counts a jump; whether it is taken.
    fn is_taken(&mut self, times: u16, counter: u8) -> bool {
        if times == FOR_EVER {
            return true;
        }
        match self.jumped.get_mut(usize::from(counter)) {
            Some(jumped) if *jumped < times => {
                *jumped += 1;
                true
            }
            // Reached again it is not taken any more, as ArduPilot and PX4 have it.
            Some(_) | None => false,
        }
    }
}

impl Route<'static> {
    /// The landing that is nearest: the index at which its sequence begins, and its own;
    /// none if there is none.
    pub fn nearest_landing(&self, here: &OverGround) -> Option<(usize, usize)> {
        let landings = self.steps.iter().enumerate();
        let away = landings.filter_map(|(index, step)| match step {
            Step::Land { at, .. } => Some((index, length(here.motion_in(at).position_m))),
            _ => None,
        });
        let (land, _) = away.min_by(|(_, one_m), (_, other_m)| one_m.total_cmp(other_m))?;
        let begin = Sequence::new(Steps::Plan(*self)).before_landing(land)?;
        Some((begin, land))
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::*;
    use crate::path::LocalPlane;

    fn place() -> Step {
        Step::Waypoint {
            at: LocalPlane::at(0.5, 0.5),
            altitude_m: 0.0,
            within_m: f64::INFINITY,
        }
    }

    fn sequence(steps: Vec<Step>) -> Sequence {
        Sequence::new(Steps::Plan(Route {
            steps: Box::leak(steps.into_boxed_slice()),
            ..Route::default()
        }))
    }

    fn order(sequence: &mut Sequence) -> Vec<usize> {
        let mut order = Vec::new();
        let mut from = 0;
        while let Some((index, _)) = sequence.next(from, &mut |_| {}) {
            order.push(index);
            from = index + 1;
            assert!(order.len() < 100);
        }
        order
    }

    /// MAVLink's `DO_JUMP`: item 3 jumps to item 1 twice, so 1 and 2 are flown three
    /// times.
    #[test]
    fn a_jump_is_taken_as_often_as_it_says() {
        let jump = Step::Jump {
            to: 0,
            times: 2,
            counter: 0,
        };
        let mut steps = sequence(std::vec![place(), place(), jump, place()]);
        assert_eq!(order(&mut steps), [0, 1, 0, 1, 0, 1, 3]);
    }

    #[test]
    fn a_jump_over_nothing_ends() {
        let jump = Step::Jump {
            to: 0,
            times: FOR_EVER,
            counter: 0,
        };
        assert_eq!(order(&mut sequence(std::vec![Step::Mark, jump])), []);
    }

    /// A delay holds what follows back, but no longer than to the next place.
    #[test]
    fn a_delay_ends_with_its_time_or_at_the_place() {
        let steps = std::vec![
            place(),
            Step::Airspeed(50.0),
            Step::Delay(5.0),
            Step::Airspeed(40.0),
            place(),
            place(),
        ];
        for waits in [true, false] {
            let mut sequence = sequence(steps.clone());
            let mut seen = Vec::new();
            let mut effect = |step: &Step| seen.push(*step);
            assert_eq!(sequence.next(0, &mut effect).map(|(n, _)| n), Some(0));
            assert_eq!(sequence.next(1, &mut effect).map(|(n, _)| n), Some(4));
            sequence.wait(4.9, 1e4, &mut effect);
            if waits {
                sequence.wait(0.2, 1e4, &mut effect);
            } else {
                assert_eq!(sequence.next(5, &mut effect).map(|(n, _)| n), Some(5));
            }
            assert_eq!(seen, [Step::Airspeed(50.0), Step::Airspeed(40.0)]);
        }
    }
}
