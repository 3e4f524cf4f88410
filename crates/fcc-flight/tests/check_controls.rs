//! Controls are checked on the built-in aircraft on its runway.
#![cfg(test)]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use fcc_flight::config::Config;
use fcc_flight::flight::{
    Checked, Onlooker, Reply, Seen, Unchecked, Verdict, assemble, check_controls,
};

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

/// Gives these answers, and then no more.
struct Person {
    replies: Vec<Reply>,
    asked: Vec<String>,
}

impl Onlooker for Person {
    fn ask(&mut self, question: &str) {
        self.asked.push(question.to_owned());
    }

    fn reply(&mut self) -> Option<Reply> {
        self.replies.pop()
    }
}

const STANDS: &str = "[built-in]\non_runway = true\nnoise = false\n";

/// The check of an aircraft that is wired so; it has released the controls.
fn checked(
    text: &str,
    as_wired: fn(Surfaces) -> Surfaces,
    throttle: bool,
    person: Option<&mut Person>,
) -> Checked {
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
    let onlooker = person.map(|person| person as &mut dyn Onlooker);
    let found = check_controls(
        assembly,
        &config,
        throttle,
        &mut (),
        onlooker,
        &mut |words| panic!("{words}"),
    );
    assert!(released.load(Ordering::Relaxed));
    assert!(found.released);
    found
}

fn verdicts(found: &Checked) -> Vec<(&'static str, f64, Verdict)> {
    let movements = found.movements.iter();
    let all = movements.map(|one| (one.control, one.commanded[1], one.verdict));
    all.collect()
}

#[test]
fn controls_that_are_measured_to_move_as_commanded_are_right() {
    let found = checked(STANDS, |right| right, false, None);
    assert!(found.ended.is_ok());
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
    let found = checked(STANDS, wired, false, None);
    assert!(found.ended.is_ok());
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
    let mut replies = [Seen::Yes; 6].map(Reply::Seen);
    replies[3] = Reply::Seen(Seen::OtherWay);
    replies[5] = Reply::Seen(Seen::No);
    replies.reverse();
    let mut person = Person {
        replies: replies.to_vec(),
        asked: Vec::new(),
    };
    let found = checked(STANDS, |right| right, false, Some(&mut person));
    assert!(found.ended.is_ok());
    let expected = [
        ("elevator", 1.0, Verdict::Ok),
        ("elevator", -1.0, Verdict::Ok),
        ("aileron", 1.0, Verdict::Ok),
        ("aileron", -1.0, Verdict::Reversed),
        ("rudder", 1.0, Verdict::Ok),
        ("rudder", -1.0, Verdict::NoEffect),
    ];
    assert_eq!(verdicts(&found), expected);
    assert!(person.asked[0].contains("elevator's trailing edge go UP"));
    assert!(person.asked[2].contains("RIGHT aileron go UP"));
    assert!(person.asked[4].contains("RIGHT"));
}

#[test]
fn a_person_ends_it_and_the_controls_are_released() {
    let mut person = Person {
        replies: vec![Reply::Quit, Reply::Seen(Seen::Yes)],
        asked: Vec::new(),
    };
    let found = checked(STANDS, |right| right, false, Some(&mut person));
    assert!(matches!(found.ended, Err(Unchecked::Ended)));
    assert_eq!(found.movements.len(), 1);
}

#[test]
fn the_throttle_is_moved_only_if_it_is_asked_for() {
    let found = checked(STANDS, |right| right, true, None);
    let (control, at, verdict) = *verdicts(&found).last().unwrap();
    assert_eq!((control, at, verdict), ("throttle", 1.0, Verdict::Ok));
}

#[test]
fn an_aircraft_that_flies_is_refused() {
    let found = checked("[built-in]\n", |right| right, false, None);
    // 100 kt indicated at 3,000 ft are 104.5 kt.
    let Err(Unchecked::Moves { knots, of }) = found.ended else {
        panic!("not refused");
    };
    assert!((knots - 104.5).abs() < 1.5, "{knots}");
    assert_eq!(of, "ground speed");
    assert_eq!(found.movements, []);
}
