//! A multicopter flown, recorded and replayed as a program does it.

use std::io;
use std::path::Path;
use std::sync::{Arc, Mutex};

use fcc_core::framework::RecordOf;
use fcc_flight::flight::{Conclusion, Figure, FlightTime, Host, Observer, Outcome, Pace};
use fcc_flight::vehicle::{MulticopterFile, Vehicle, Wishes, fly_vehicle, parse, replay_vehicle};
use fcc_multicopter::Multicopter;
use fcc_replay::{Chain, Identity};
use fcc_runtime::StopHandle;

const SHIPPED: &str = include_str!("../../../../config/multicopter.toml");
const PLANS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../config/plans");

fn recorded_into(folder: &Path) -> MulticopterFile {
    let mut config = MulticopterFile::default();
    let wishes = Wishes {
        recordings: Some(folder),
        ..Wishes::default()
    };
    Multicopter::apply(&mut config, &wishes).unwrap();
    config
}

fn fly(config: &MulticopterFile, host: &mut dyn Host) -> Outcome {
    let pace = (Pace::Lockstep, None);
    fly_vehicle::<Multicopter>(config, None, pace, Vec::new(), host).unwrap()
}

fn figure(outcome: &Outcome, name: &str) -> f64 {
    let named = |figure: &&Figure| figure.name.contains(name);
    outcome.figures.iter().find(named).unwrap().value
}

/// The tour of 65 s: within the corridor and the landing of issue 46, and every output again.
#[test]
fn a_flight_is_scored_and_replayed_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = fly(&recorded_into(folder.path()), &mut ());
    assert_eq!(
        outcome.conclusion,
        Conclusion::Completed,
        "{}",
        outcome.ending
    );
    assert_eq!(outcome.ending, "it has landed");
    assert!(figure(&outcome, "largest") < 1.0);
    assert!(figure(&outcome, "off its place") < 1.0);
    assert!((0.05..0.7).contains(&figure(&outcome, "sink")));
    let flown = outcome.events.iter();
    let items = flown.filter(|event| event.text.ends_with("of the plan is flown"));
    assert_eq!(items.count(), 7);

    let files = outcome.recording.unwrap().files;
    let files: Vec<_> = files.into_iter().map(Into::into).collect();
    let chain = Chain::open::<Multicopter>(&files).unwrap();
    assert_eq!(chain.about().plant, "multicopter");
    let mut replay = replay_vehicle::<Multicopter>(&chain).unwrap();
    let mut identity = Identity::of::<Multicopter>();
    let replayed = chain.replay(&mut replay, |one, again| identity.take(one, again), |_| {});
    assert!(replayed.is_complete() && replayed.run.ticks > 20_000);
    assert!(identity.is_identical(), "{}", identity.to_text());
}

/// Stops the flight after 12 s, in the air.
#[derive(Clone, Default)]
struct Stopper(Arc<Mutex<StopHandle>>);

impl Host for Stopper {
    fn attach(&mut self, stop: &StopHandle) -> io::Result<()> {
        *self.0.lock().unwrap() = stop.clone();
        Ok(())
    }

    fn interrupted_by(&self) -> Option<&'static str> {
        Some("a signal")
    }
}

impl Observer<Multicopter> for Stopper {
    fn record(&mut self, _: &RecordOf<Multicopter>, at: &FlightTime) {
        if at.time_s > 12.0 {
            self.0.lock().unwrap().stop();
        }
    }
}

#[test]
fn a_flight_that_is_stopped_in_the_air_lands_first() {
    let folder = tempfile::tempdir().unwrap();
    let config = recorded_into(folder.path());
    let mut stopper = Stopper::default();
    let observers: Vec<Box<dyn Observer<Multicopter>>> = vec![Box::new(stopper.clone())];
    let pace = (Pace::Lockstep, None);
    let outcome = fly_vehicle::<Multicopter>(&config, None, pace, observers, &mut stopper).unwrap();
    assert_eq!(outcome.ending, "interrupted by a signal");
    assert!(outcome.interrupted && outcome.released && outcome.impact.is_none());
    let at = |words: &str| {
        let found = outcome
            .events
            .iter()
            .find(|event| event.text.contains(words));
        found.unwrap_or_else(|| panic!("{words}")).time_s
    };
    assert!((at("mode: land") - 12.0).abs() < 0.1);
    assert!(
        at("release sent") > at("mode: land") + 5.0,
        "from 10 m with 1.5 m/s"
    );
    assert!(figure(&outcome, "sink") < 0.7);
}

/// The file has every key with its default.
#[test]
fn the_shipped_configuration_is_the_default() {
    let shipped = parse::<Multicopter>(SHIPPED, "multicopter.toml").unwrap();
    let values = |config: &MulticopterFile| toml::Value::try_from(config).unwrap();
    assert_eq!(values(&shipped), values(&MulticopterFile::default()));
}

#[test]
fn what_cannot_be_flown_is_refused_by_its_place() {
    let said = |text: &str| {
        let error = parse::<Multicopter>(text, "m.toml").unwrap_err();
        error.to_string()
    };
    let with = |keys: &str| format!("vehicle = \"multicopter\"\n{keys}");
    for (keys, expected) in [
        (
            "[limits]\nspeed_mps = 40.0",
            "limits.speed_mps is 40: from 0.5 to 20",
        ),
        (
            "[sensors]\nlatency_ms = 80.0",
            "by 112 ms, and at most 88 ms can be flown",
        ),
        (
            "[airframe]\nmass_kg = 4.0",
            "hovering takes 83 % of the thrust",
        ),
        ("[airframe]\nmas_kg = 4.0", "m.toml:3"),
        (
            "[[plan]]\nkind = \"take-off\"\nheight_m = 5.0\n[[plan]]\nkind = \"hover\"\nseconds = 1",
            "item 2 of the plan: a plan ends with a return or a landing",
        ),
    ] {
        let said = said(&with(keys));
        assert!(said.contains(expected), "{said}");
    }
}

/// A plan of a ground station; what only an aeroplane does is refused with its number.
#[test]
fn plans_of_ground_stations_are_read() {
    let text = "QGC WPL 110\n\
        0\t1\t0\t16\t0\t0\t0\t0\t47.0\t8.0\t400\t1\n\
        1\t0\t3\t22\t0\t0\t0\t0\t47.0\t8.0\t10\t1\n\
        2\t0\t3\t16\t0\t0\t0\t0\t47.0005\t8.0\t20\t1\n\
        3\t0\t3\t21\t0\t0\t0\t0\t47.0005\t8.0005\t0\t1\n";
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("plan.waypoints");
    std::fs::write(&file, text).unwrap();
    let apply = |file: &Path| {
        let mut config = MulticopterFile::default();
        let wishes = Wishes {
            plan: Some(file),
            not_recorded: true,
            ..Wishes::default()
        };
        Multicopter::apply(&mut config, &wishes).map(|()| config)
    };
    let config = apply(&file).unwrap();
    let outcome = fly(&config, &mut ());
    assert_eq!(
        outcome.conclusion,
        Conclusion::Completed,
        "{}",
        outcome.ending
    );
    assert!(figure(&outcome, "off its place") < 1.0);
    // 0.0005° are 55.6 m north (111,170 m a degree at 47°) and 38.0 m east (76,056 m).
    let plan = toml::Value::try_from(&config).unwrap();
    let land = plan["plan"][2].as_table().unwrap();
    assert!((land["north_m"].as_float().unwrap() - 55.6).abs() < 0.1);
    assert!((land["east_m"].as_float().unwrap() - 38.0).abs() < 0.1);

    let refused = apply(&Path::new(PLANS).join("circuit.waypoints")).unwrap_err();
    // It begins its landing at item 7, and that is an aeroplane's.
    assert!(
        refused.contains("item 2 (change speed): a multicopter does not fly it"),
        "{refused}"
    );
}
