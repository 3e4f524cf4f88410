//! The pilot's own controls: moved beyond a threshold, they end the engagement.
//!
//! A deflection counts from where the control rests: the median of the second
//! before engaging, so that a stick that rests off zero takes nothing over. While
//! it is beyond the threshold its rest follows twenty times slower: engaging is
//! refused, until it is back or has stayed there for 10 s.

use core::time::Duration;

use super::Autopilot;
use fcc_core::flight::{Measurements, PilotControls};
use fcc_core::framework::{Notice, Reading, Time};

/// The kind of the notice of the first axis; the next two are the others.
const FIRST_KIND: u8 = 6;
/// The axes, in the order of the kinds.
const AXES: [&str; 3] = ["pitch", "roll", "yaw"];

/// How many samples a median is made of, and their distances: a second's, and of
/// a control that is beyond the threshold half of 20 s.
const SAMPLES: usize = 9;
const APART: Duration = Duration::from_millis(125);
const APART_WHEN_MOVED: Duration = Duration::from_millis(2_500);

/// When the pilot takes over.
///
/// ```
/// use core::time::Duration;
/// use fcc_fixed_wing::StickTakeover;
///
/// let half = StickTakeover { threshold: 0.5, after: Duration::from_millis(200) };
/// assert!(half.threshold <= 1.0);
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StickTakeover {
    /// The deflection of any axis from where it rests, of full deflection: 0.05
    /// to 1.
    pub threshold: f64,
    /// For how long it must be beyond it; at least two readings are needed.
    pub after: Duration,
}

/// An axis: where it rests, and since when it is beyond the threshold.
#[derive(Clone, Copy, Debug, Default)]
struct Axis {
    samples: [f64; SAMPLES],
    count: usize,
    /// The first reading beyond the threshold; never while it is not.
    first: Time,
    /// Whether the last reading was not beyond it, though the one before was.
    is_contradicted: bool,
    /// Beyond it for long enough.
    is_moved: bool,
    /// The present deflection from where it rests.
    deflection: f64,
}

impl Axis {
    /// The median of the samples; `None` without one.
    fn rest(&self) -> Option<f64> {
        let mut sorted = self.samples;
        let known = sorted.get_mut(..self.count.min(SAMPLES))?;
        known.sort_unstable_by(f64::total_cmp);
        known.get(known.len() / 2).copied()
    }

    fn sample(&mut self, value: f64) {
        if let Some(sample) = self.samples.get_mut(self.count % SAMPLES) {
            *sample = value;
        }
        // Goes round above a full set.
        self.count = if self.count + 1 == 2 * SAMPLES {
            SAMPLES
        } else {
            self.count + 1
        };
    }

    fn forget_deflection(&mut self) {
        (self.first, self.is_contradicted, self.is_moved) = (Time::NEVER, false, false);
    }

    /// A new reading. One alone is a bad one, either way.
    fn follow(&mut self, value: f64, taken: Time, takeover: &StickTakeover) {
        self.deflection = self.rest().map_or(0.0, |rest| value - rest);
        if self.deflection.abs() > takeover.threshold {
            self.is_contradicted = false;
            if self.first.is_never() {
                self.first = taken;
            } else if taken > self.first {
                self.is_moved |= taken.since(self.first) >= takeover.after;
            }
        } else if self.is_contradicted {
            self.forget_deflection();
        } else {
            self.is_contradicted = !self.first.is_never();
        }
    }
}

/// Whether the pilot moves the controls.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PilotTakeover {
    takeover: Option<StickTakeover>,
    axes: [Axis; 3],
    last: Time,
    sampled: Time,
    is_engaged: bool,
}

impl PilotTakeover {
    pub(super) fn new(takeover: Option<StickTakeover>) -> Self {
        Self {
            takeover,
            ..Self::default()
        }
    }

    /// Whether the autopilot has the controls.
    pub(super) const fn is_engaged(&self) -> bool {
        self.is_engaged
    }

    /// The controls are no longer the pilot's, or are again.
    pub(super) const fn set_engaged(&mut self, is_engaged: bool) {
        self.is_engaged = is_engaged;
    }

    /// Whether a control is beyond the threshold.
    pub(super) fn is_moved(&self) -> bool {
        self.axes.iter().any(|axis| axis.is_moved)
    }

    /// Follows the readings; that the pilot has just taken over. One that is not valid has
    /// not arrived.
    pub(super) fn step(
        &mut self,
        reading: &Reading<PilotControls>,
        now: Time,
        max_age: Duration,
    ) -> Option<Notice> {
        let takeover = self.takeover?;
        let fresh = reading.fresh(now, max_age);
        let new = fresh.filter(|controls| controls.is_valid() && reading.taken > self.last);
        let Some(controls) = new else {
            if now.since(self.last) > max_age {
                self.axes.iter_mut().for_each(Axis::forget_deflection);
            }
            return None;
        };
        self.last = reading.taken;
        let was_moved = self.is_moved();
        let values = [controls.pitch, controls.roll, controls.yaw];
        for (axis, value) in self.axes.iter_mut().zip(values) {
            axis.follow(value, reading.taken, &takeover);
        }
        let takes_over = self.is_engaged && !was_moved;
        let event = self.moved_notice().filter(|_| takes_over);
        self.learn_rest(values, reading.taken);
        event
    }

    /// Samples where the controls rest: not while engaged, once that is known.
    fn learn_rest(&mut self, values: [f64; 3], taken: Time) {
        let is_known = self.axes.iter().all(|axis| axis.count >= SAMPLES);
        let is_away = self.axes.iter().any(|axis| !axis.first.is_never());
        let apart = if is_away { APART_WHEN_MOVED } else { APART };
        let is_due = self.sampled.is_never() || taken.since(self.sampled) >= apart;
        if is_due && !(self.is_engaged && is_known) {
            self.sampled = taken;
            for (axis, value) in self.axes.iter_mut().zip(values) {
                axis.sample(value);
            }
        }
    }

    fn moved_notice(&self) -> Option<Notice> {
        let moved = (FIRST_KIND..)
            .zip(&self.axes)
            .find(|(_, axis)| axis.is_moved);
        moved.map(|(kind, axis)| Notice {
            kind,
            amount_permille: (axis.deflection.abs() * 1_000.0).min(2_000.0) as u16,
            ..Notice::default()
        })
    }
}

impl Autopilot {
    /// Follows the pilot's controls.
    pub(super) fn follow_pilot(&mut self, now: Time, measured: &Measurements) {
        let max_age = self.config.max_age;
        let event = self
            .supervisor
            .pilot
            .step(&measured.pilot_controls, now, max_age);
        if let Some(event) = event {
            self.journal.add(event);
        }
    }
}

/// The axis of a notice of a takeover; `None` if it is another notice.
pub(super) fn axis_of(kind: u8) -> Option<&'static str> {
    let index = kind.checked_sub(FIRST_KIND)?;
    AXES.get(usize::from(index)).copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const MS: i64 = 1_000_000;

    struct Stick {
        pilot: PilotTakeover,
        tick: i64,
        events: Vec<Notice>,
    }

    impl Stick {
        fn new() -> Self {
            let takeover = StickTakeover {
                threshold: 0.3,
                after: Duration::from_millis(200),
            };
            let pilot = PilotTakeover::new(Some(takeover));
            Self {
                pilot,
                tick: 0,
                events: Vec::new(),
            }
        }

        fn at(&mut self, roll: f64) -> bool {
            self.tick += 1;
            let now = Time::from_nanos(self.tick * 25 * MS);
            let controls = PilotControls {
                roll,
                ..PilotControls::default()
            };
            let reading = Reading::new(controls, now);
            let event = self.pilot.step(&reading, now, Duration::from_millis(250));
            self.events.extend(event);
            self.pilot.is_moved()
        }

        fn engaged_at(rest: f64) -> Self {
            let mut stick = Self::new();
            assert!((0..80).all(|_| !stick.at(rest)));
            stick.pilot.set_engaged(true);
            stick
        }
    }

    #[test]
    fn a_deflection_counts_after_a_fifth_of_a_second() {
        let mut stick = Stick::engaged_at(0.0);
        let moved: [bool; 10] = core::array::from_fn(|_| stick.at(-0.5));
        // The ninth reading comes 0.2 s after the first.
        assert_eq!(moved.iter().position(|moved| *moved), Some(8));
    }

    #[test]
    fn the_notice_names_axis_and_deflection_once() {
        let mut stick = Stick::engaged_at(0.1);
        (0..40).for_each(|_| {
            stick.at(0.6);
        });
        let [notice] = stick.events[..] else {
            panic!("{:?}", stick.events);
        };
        assert_eq!(axis_of(notice.kind), Some("roll"));
        assert_eq!(notice.amount_permille, 500);
    }

    #[test]
    fn single_bad_readings_change_nothing() {
        let mut stick = Stick::engaged_at(0.0);
        for tick in 0..400 {
            let value = if tick % 3 == 0 { 1.0 } else { 0.0 };
            assert!(!stick.at(value), "{tick}");
        }
        // And of a stick that is held there, one good reading among bad ones too.
        let moved = (0..40).any(|tick| stick.at(if tick % 4 == 3 { 0.0 } else { 1.0 }));
        assert!(moved);
        let mut stick = Stick::engaged_at(0.0);
        let nan = (0..40).any(|tick| stick.at(if tick % 2 == 0 { f64::NAN } else { 1.0 }));
        assert!(nan, "what is not a number is none");
        let mut stick = Stick::engaged_at(0.0);
        assert!((0..40).all(|_| !stick.at(f64::NAN)));
    }

    #[test]
    fn a_stick_that_rests_off_zero_takes_nothing_over() {
        let mut stick = Stick::engaged_at(0.4);
        assert!((0..400).all(|_| !stick.at(0.4)));
        assert!((0..9).any(|_| stick.at(0.75)));
    }

    #[test]
    fn it_stays_moved_until_it_is_back_or_has_rested_for_ten_seconds() {
        let mut stick = Stick::engaged_at(0.0);
        assert!((0..9).any(|_| stick.at(0.8)));
        stick.pilot.set_engaged(false);
        assert!((0..320).all(|_| stick.at(0.8)), "8 s");
        stick.at(0.0);
        assert!(!stick.at(0.0), "back");
        assert!((0..9).any(|_| stick.at(0.8)));
        assert!(!(0..520).all(|_| stick.at(0.8)), "13 s there");
    }

    #[test]
    fn what_has_not_arrived_counts_for_nothing() {
        let mut stick = Stick::engaged_at(0.0);
        assert!(!stick.at(0.8));
        let old = Reading::new(
            PilotControls {
                roll: 0.8,
                ..PilotControls::default()
            },
            Time::from_nanos(stick.tick * 25 * MS),
        );
        for _ in 0..40 {
            stick.tick += 1;
            let now = Time::from_nanos(stick.tick * 25 * MS);
            stick.pilot.step(&old, now, Duration::from_millis(250));
            assert!(!stick.pilot.is_moved());
        }
    }
}
