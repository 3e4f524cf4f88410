//! A flight whose plan was replaced.

use std::path::Path;

use fcc_fixed_wing::PlanReplacement;

use super::*;
use crate::config::PreparedPlan;

const UPLOADED_S: u64 = 1_790_000_005;

fn plan(north_deg: f64) -> PreparedPlan {
    let text =
        format!("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 900 1\n1 0 0 16 0 0 0 0 {north_deg} 8 900 1\n");
    Config::default()
        .prepare_again(&text, 1, UPLOADED_S)
        .unwrap()
}

/// A tick of it, engaged.
fn flown(plan: &PreparedPlan) -> FlightMessage {
    let Message::Tick(mut record) = engaged(&FLOWN) else {
        panic!("no tick")
    };
    record.setpoints.plan_hash = plan.replacement.plan_hash;
    record.setpoints.plan_uploaded_unix_s = UPLOADED_S;
    Message::Tick(record)
}

/// Leaves the state of a flight that was broken off with this plan.
fn leave(folder: &Folder, with: &PreparedPlan) {
    let (restart, _) = Restart::begin(folder.request.clone());
    let mut restart = restart.unwrap();
    restart.take(&engaged(&FLOWN));
    restart.plans().note(Arc::new(with.clone()));
    restart.take(&flown(with));
    restart.take(&event(EventKind::Panicked));
    restart.take(&event(ENDS));
    restart.end();
}

#[test]
fn it_is_taken_up_with_the_plan_that_was_flown() {
    let folder = Folder::new(RestartMode::Warm);
    let second = plan(47.3);
    leave(&folder, &second);
    let (restart, said) = Restart::begin(folder.request.clone());
    let mut restart = restart.unwrap();
    assert!(said.unwrap().contains("recovering it"));
    let found = restart.plans().report().unwrap();
    assert_eq!(found.content, second.content);
    assert_eq!(restart.plans().report(), None, "once");
    // From which item, the resumption says.
    let expected = PlanReplacement {
        item: 0,
        ..second.replacement
    };
    assert_eq!(found.replacement, expected);

    let parts = Parts {
        timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
        sensors: Vec::new(),
        controller: Autopilot::new(Config::default().autopilot_config()),
        actuators: Vec::new(),
    };
    let (_machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
    let room = link.commands.room();
    let mut recovery = restart.recovery.take().unwrap();
    recovery.command(&mut link.commands, FLOWN);
    // To engage, the plan, and what was flown.
    assert_eq!(room - link.commands.room(), 3);
}

#[test]
fn without_its_plan_it_stands_by_and_says_why() {
    type Change = fn(&Path);
    let reasons: [(&str, Change); 3] = [
        ("is not there", |path| fs::remove_file(path).unwrap()),
        ("is damaged", |path| {
            let mut bytes = fs::read(path).unwrap();
            *bytes.last_mut().unwrap() ^= 1;
            fs::write(path, bytes).unwrap();
        }),
        ("has another one", |path| {
            let state = path.with_file_name("fccd.flight");
            kept_plan::write(&state, &plan(47.5).content).unwrap();
        }),
    ];
    for (because, change) in reasons {
        let folder = Folder::new(RestartMode::Warm);
        leave(&folder, &plan(47.4));
        change(&folder.request.path.with_file_name("fccd.flight.plan"));
        let (recovered, said) = folder.found();
        assert!(!recovered && said.contains(because), "{said}");
        assert!(said.contains("is not that of plan.file"), "{said}");
        assert!(said.ends_with("staying in standby"), "{said}");
    }
}

/// Nothing of it is left, and a state without a plan is as before.
#[test]
fn a_regular_end_removes_it() {
    let folder = Folder::new(RestartMode::Warm);
    leave(&folder, &plan(47.3));
    let (restart, _) = Restart::begin(RestartRequest {
        mode: RestartMode::Cold,
        ..folder.request.clone()
    });
    restart.unwrap().end();
    let left: Vec<_> = fs::read_dir(folder.folder.path()).unwrap().collect();
    // The lock.
    assert_eq!(left.len(), 1, "{left:?}");
    folder.leave(2, |_| {});
    assert!(folder.found().0);
}
