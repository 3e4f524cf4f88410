//! Controls are checked on the built-in aircraft on its runway.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use fcc_flight::config::Config;
use fcc_flight::flight::{Checked, Unchecked, Verdict, assemble, check_controls};

/// A servo that is wired otherwise.
struct Wired {
    actuator: Box<dyn Actuator<Surfaces>>,
    as_wired: fn(Surfaces) -> Surfaces,
    released: Arc<AtomicBool>,
}

impl Actuator<Surfaces> for Wired {
    fn apply(&mut self, tick: &Tick, outputs: &Surfaces) -> Result<(), ActuatorFault> {
        self.released.store(false, Ordering::Relaxed);
        self.actuator.apply(tick, &(self.as_wired)(*outputs))
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        self.released.store(true, Ordering::Relaxed);
        self.actuator.release()
    }

    fn name(&self) -> &str {
        self.actuator.name()
    }
}

const STANDS: &str = "[built-in]\non_runway = true\nnoise = false\n";

/// The check of an aircraft that is wired so, with a person if there are answers, and what was
/// asked. It has released the controls.
fn checked_by(
    text: &str,
    as_wired: fn(Surfaces) -> Surfaces,
    throttle: bool,
    answers: &[Option<Verdict>],
) -> (Checked, Vec<String>) {
    let config = Config::parse(text, "test").unwrap();
    let mut assembly = assemble(&config).unwrap();
    let released = Arc::new(AtomicBool::new(false));
    let actuators = std::mem::take(&mut assembly.actuators);
    let wired = actuators.into_iter().map(|actuator| {
        let released = Arc::clone(&released);
        Box::new(Wired {
            actuator,
            as_wired,
            released,
        }) as Box<dyn Actuator<Surfaces>>
    });
    assembly.actuators = wired.collect();
    let (to, from) = channel();
    let mut asked = Vec::new();
    let found = check_controls(
        assembly,
        &config,
        throttle,
        &mut (),
        (!answers.is_empty()).then_some(&from),
        &mut |question| {
            to.send(answers[asked.len()]).unwrap();
            asked.push(question);
        },
    );
    assert!(released.load(Ordering::Relaxed));
    assert!(found.released);
    (found, asked)
}

fn checked(text: &str, as_wired: fn(Surfaces) -> Surfaces) -> Checked {
    checked_by(text, as_wired, false, &[]).0
}

fn verdicts(found: &Checked) -> Vec<(&'static str, f64, Verdict)> {
    let movements = found.movements.iter();
    let all = movements.map(|one| (one.control, one.commanded[1], one.verdict));
    all.collect()
}

#[test]
fn controls_that_are_measured_to_move_as_commanded_are_right() {
    let found = checked(STANDS, |right| right);
    found.ended.as_ref().unwrap();
    let surfaces = ["elevator", "aileron", "rudder"];
    let expected = surfaces.map(|name| [(name, 1.0, Verdict::Ok), (name, -1.0, Verdict::Ok)]);
    assert_eq!(verdicts(&found), expected.concat());
    for one in &found.movements {
        for (moved, commanded) in one.read_back.into_iter().zip(one.commanded) {
            assert!((moved.unwrap() - commanded).abs() < 0.02, "{one:?}");
        }
    }
}

#[test]
fn a_reversed_control_and_one_that_does_not_move_are_found() {
    let wired = |outputs: Surfaces| Surfaces {
        elevator: -outputs.elevator,
        aileron: 0.2,
        ..outputs
    };
    let found = checked(STANDS, wired);
    found.ended.as_ref().unwrap();
    let of = |name: &str| {
        let all = verdicts(&found).into_iter();
        all.filter(|(control, ..)| *control == name)
            .map(|(.., verdict)| verdict)
            .collect::<Vec<_>>()
    };
    assert_eq!(of("elevator"), [Verdict::Reversed; 2]);
    assert_eq!(of("aileron"), [Verdict::NoEffect; 2]);
    assert_eq!(of("rudder"), [Verdict::Ok; 2]);
}

#[test]
fn what_a_person_sees_counts_as_well() {
    let mut answers = [Some(Verdict::Ok); 6];
    (answers[3], answers[5]) = (Some(Verdict::Reversed), Some(Verdict::NoEffect));
    let (found, asked) = checked_by(STANDS, |right| right, false, &answers);
    found.ended.as_ref().unwrap();
    let expected = [
        ("elevator", 1.0, Verdict::Ok),
        ("elevator", -1.0, Verdict::Ok),
        ("aileron", 1.0, Verdict::Ok),
        ("aileron", -1.0, Verdict::Reversed),
        ("rudder", 1.0, Verdict::Ok),
        ("rudder", -1.0, Verdict::NoEffect),
    ];
    assert_eq!(verdicts(&found), expected);
    let expected = [
        "elevator: did its trailing edge go UP? [y/o/n/q]",
        "elevator: did its trailing edge go DOWN? [y/o/n/q]",
        "aileron: did the RIGHT one go UP, the left one down? [y/o/n/q]",
        "aileron: did the RIGHT one go DOWN, the left one up? [y/o/n/q]",
        "rudder: did its trailing edge go RIGHT? [y/o/n/q]",
        "rudder: did its trailing edge go LEFT? [y/o/n/q]",
    ];
    assert_eq!(asked, expected);
}

#[test]
fn a_person_ends_it_and_the_controls_are_released() {
    let answers = [Some(Verdict::Ok), None];
    let (found, _) = checked_by(STANDS, |right| right, false, &answers);
    assert!(matches!(found.ended, Err(Unchecked::Ended)));
    assert_eq!(found.movements.len(), 1);
}

#[test]
fn the_throttle_is_moved_only_if_it_is_asked_for() {
    let found = checked_by(STANDS, |right| right, true, &[]).0;
    let (control, at, verdict) = *verdicts(&found).last().unwrap();
    assert_eq!((control, at, verdict), ("throttle", 1.0, Verdict::Ok));
}

#[test]
fn an_aircraft_that_flies_is_refused() {
    let found = checked("[built-in]\n", |right| right);
    // 100 kt indicated at 3,000 ft are 104.5 kt.
    let Err(Unchecked::Moves(knots)) = found.ended else {
        panic!("not refused");
    };
    assert!((knots - 104.5).abs() < 1.5, "{knots}");
    assert_eq!(found.movements, []);
}
