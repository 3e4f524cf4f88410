//! The evaluation of a state file that is found at the start.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, AtomicU32, Ordering};

use fcc_core::flight::Measurements;
use fcc_core::framework::{
    ActuatorFault, ControlAuthority, Event, PlantId, Reading, Record, Released, Tick, Time,
};
use fcc_fixed_wing::{Autopilot, Setpoints};
use fcc_guidance::Mode;
use fcc_runtime::{LoopConfig, Machine, Parts};
use fcc_timer::ManualTimer;
use tempfile::TempDir;

use super::super::observer::{Access, Facts, FlightTime, Observer, Reports};
use super::super::plan::Pace;
use super::*;

mod flown;
mod foreign_files;
mod late_disk;
mod replaced_plan;

use flown::FLOWN;

/// A folder with the state left by a flight.
struct Folder {
    folder: TempDir,
    request: RestartRequest,
}

impl Folder {
    fn new(mode: RestartMode) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let request = RestartRequest {
            mode,
            max_age: Duration::from_secs(60),
            path: folder.path().join("fccd.flight"),
            fingerprint: 7,
            release_left_held: true,
            config: Config::default(),
        };
        Self { folder, request }
    }

    /// Stores the state of a flight that was interrupted this many seconds ago.
    fn leave(&self, seconds_ago: u64, change: impl FnOnce(&mut Saved)) {
        let mut at = BootInstant::now().unwrap();
        at.ns = at.ns.saturating_sub(seconds_ago * 1_000_000_000);
        let mut saved = Saved {
            at,
            config: 7,
            switch: SavedSwitch {
                on: true,
                source: 0,
            },
            recoveries: 0,
            plan: SavedPlan::default(),
            resume: FLOWN,
            commanded: SavedCommands::default(),
        };
        change(&mut saved);
        state_file::write(&self.request.path, &saved).unwrap();
    }

    /// Whether it is to be recovered, and the message.
    fn found(&self) -> (bool, String) {
        let (restart, words) = Restart::begin(self.request.clone());
        let restart = restart.expect("the path is usable");
        let recovery = restart.recovery.is_some();
        restart.end();
        (recovery, words.unwrap_or_default())
    }

    fn is_kept(&self) -> bool {
        self.request.path.exists()
    }
}

#[test]
fn without_a_state_file_nothing_is_reported() {
    for mode in [RestartMode::Cold, RestartMode::Warm] {
        assert_eq!(Folder::new(mode).found(), (false, String::new()));
    }
}

#[test]
fn a_recent_flight_is_recovered_if_configured() {
    let folder = Folder::new(RestartMode::Warm);
    folder.leave(2, |_| {});
    let (recovered, said) = folder.found();
    assert!(recovered && said.contains("recovering it"), "{said}");
    assert!(folder.is_kept(), "until it is decided");
}

#[test]
fn a_cold_restart_is_reported_once() {
    let folder = Folder::new(RestartMode::Cold);
    folder.leave(2, |_| {});
    let (recovered, said) = folder.found();
    assert!(
        !recovered && said.contains("restart.mode is \"cold\""),
        "{said}"
    );
    assert_eq!(folder.found(), (false, String::new()));
}

#[test]
fn an_unsuitable_state_is_not_recovered() {
    type Change = fn(&mut Saved);
    let reasons: [(&str, u64, Change); 4] = [
        ("longer than restart.max_age_s, 60 s", 61, |_| {}),
        ("before this machine was last started", 2, |saved| {
            saved.at.boot = "another".to_owned();
        }),
        ("another configuration", 2, |saved| saved.config = 8),
        ("recovered 3 times in a row", 2, |saved| {
            saved.recoveries = 3;
        }),
    ];
    for (because, seconds_ago, change) in reasons {
        let folder = Folder::new(RestartMode::Warm);
        folder.leave(seconds_ago, change);
        let (recovered, said) = folder.found();
        assert!(!recovered && said.contains(because), "{said}");
        assert!(said.contains("staying in standby"), "{said}");
        assert!(!folder.is_kept());
    }
}

#[test]
fn a_damaged_file_is_reported_and_a_foreign_one_kept() {
    let folder = Folder::new(RestartMode::Warm);
    fs::write(&folder.request.path, "fccd-flight 2 0\n{").unwrap();
    let (recovered, said) = folder.found();
    assert!(!recovered && said.contains("damaged"), "{said}");

    fs::write(&folder.request.path, "my diary\n").unwrap();
    let (restart, said) = Restart::begin(folder.request.clone());
    assert!(restart.is_none());
    assert!(said.unwrap().contains("not a state file of fccd"));
    assert_eq!(
        fs::read_to_string(&folder.request.path).unwrap(),
        "my diary\n"
    );
}

#[test]
fn two_daemons_do_not_share_a_file() {
    let folder = Folder::new(RestartMode::Warm);
    folder.leave(2, |_| {});
    let (first, _) = Restart::begin(folder.request.clone());
    let (second, said) = Restart::begin(folder.request.clone());
    assert!(first.is_some() && second.is_none());
    assert!(said.unwrap().contains("another fccd"));
}

#[test]
fn an_impossible_path_is_reported() {
    let mut folder = Folder::new(RestartMode::Warm);
    fs::write(folder.folder.path().join("file"), "").unwrap();
    folder.request.path = folder.folder.path().join("file/fccd.flight");
    let (restart, said) = Restart::begin(folder.request.clone());
    assert!(restart.is_none());
    assert!(
        said.unwrap()
            .contains("this flight cannot be recovered after a restart")
    );
}

fn event(kind: EventKind<AutopilotCommand>) -> FlightMessage {
    Message::Event(Event {
        tick: 0,
        time: Time::from_nanos(0),
        kind,
    })
}

/// A tick with this switch of a sensor, read now.
fn switched(tick: &FlightMessage, source: u8, switch: Switch) -> FlightMessage {
    static NOW_NS: AtomicI64 = AtomicI64::new(0);
    let Message::Tick(record) = tick else {
        panic!("no tick")
    };
    let engage_switch = Reading::new(
        switch,
        Time::from_nanos(NOW_NS.fetch_add(25_000_000, Ordering::Relaxed)),
    );
    let engage_switch = Reading {
        source,
        ..engage_switch
    };
    Message::Tick(Record {
        measurements: Measurements {
            engage_switch,
            ..record.measurements
        },
        ..*record
    })
}

/// A tick with this state engaged.
fn engaged(resume: &Resume) -> FlightMessage {
    Message::Tick(Record {
        setpoints: Setpoints {
            guidance: resume.progress,
            altimeter_setting_pa: resume.altimeter_setting_pa.unwrap_or_default(),
            altitude_reference: resume.altitude_reference,
            took_off: resume.took_off,
            ..Setpoints::default()
        },
        outputs: resume.surfaces,
        ..Record::new(Tick::default(), State::Engaged)
    })
}

const ENDS: EventKind<AutopilotCommand> = EventKind::StateChanged {
    from: State::Engaged,
    to: State::Stopped,
};

/// Counts how often it is asked to release what was left held.
#[derive(Default)]
struct Authority(AtomicU32);

impl ControlAuthority for Authority {
    fn plant(&self) -> Option<PlantId> {
        None
    }

    fn held(&self) -> Option<PlantId> {
        None
    }

    fn require_permission(&self) {}

    fn permit(&self, _: &PlantId) {}

    fn report(&self, _: &mut dyn FnMut(std::fmt::Arguments<'_>)) {}

    fn release(
        &self,
        _: &PlantId,
        _: Duration,
        _: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault> {
        Ok(Released::Confirmed)
    }

    fn release_left(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn by_hand(&self) -> &'static str {
        ""
    }
}

/// How often the release of what was left held is asked for with this file, at
/// the beginning and once the first tick has come, in which the switch is off.
fn releases(folder: &Folder) -> [u32; 2] {
    let authority = Arc::new(Authority::default());
    let held: Arc<dyn ControlAuthority> = Arc::<Authority>::clone(&authority);
    let mut keeper = RestartKeeper::new(folder.request.clone(), Some(held));
    let facts = Facts {
        rate_hz: 40.0,
        timer: "",
        sensors: &[],
        actuators: &[],
        started_unix_ns: 0,
        clock_offset_ns: 0,
        pace: Pace::Lockstep,
        granted: None,
    };
    let mut reports = Reports::default();
    keeper.begin(&facts, &mut reports);
    let begun = authority.0.load(Ordering::Relaxed);
    let standby = Message::Tick(Record::new(Tick::default(), State::Standby));
    for _ in 0..2 {
        if let Message::Tick(record) = switched(&standby, 0, Switch::Off) {
            keeper.record(&record, &FlightTime::default());
        }
    }
    let parts = Parts {
        timer: Box::new(ManualTimer::new(Duration::from_millis(25)).unwrap()),
        sensors: Vec::new(),
        controller: Autopilot::new(Config::default().autopilot_config()),
        actuators: Vec::new(),
    };
    let (_machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
    for _ in 0..3 {
        keeper.poll(&mut Access {
            commands: &mut link.commands,
            reports: &mut reports,
            before_control: &mut || panic!("takes control"),
        });
    }
    [begun, authority.0.load(Ordering::Relaxed)]
}

/// Both the daemon and its release helper may have been killed.
#[test]
fn what_a_flight_that_is_not_recovered_left_held_is_released() {
    type Change = fn(&mut Saved);
    let unchanged: Change = |_| {};
    let another: Change = |saved| saved.config = 8;
    for (mode, seconds_ago, change, expected) in [
        (RestartMode::Cold, 2, unchanged, [1, 1]),
        (RestartMode::Warm, 61, unchanged, [1, 1]),
        // It waits for the first tick; then it was switched off.
        (RestartMode::Warm, 2, unchanged, [0, 1]),
        // Perhaps of another simulator.
        (RestartMode::Warm, 2, another, [0, 0]),
    ] {
        let folder = Folder::new(mode);
        folder.leave(seconds_ago, change);
        assert_eq!(releases(&folder), expected, "{mode:?} {seconds_ago}");
    }
    assert_eq!(releases(&Folder::new(RestartMode::Warm)), [0, 0]);
}

/// Mode and progress come from the record; the file has the last ones.
#[test]
fn the_recorded_state_is_stored_until_the_flight_ends_regularly() {
    let mut pattern = FLOWN;
    pattern.progress.mode = Mode::TimedPattern;
    pattern.progress.elapsed_s = 45.0;
    for (broken, is_left) in [(false, false), (true, true)] {
        let folder = Folder::new(RestartMode::Warm);
        let (restart, _) = Restart::begin(folder.request.clone());
        let mut restart = restart.unwrap();
        restart.take(&engaged(&FLOWN));
        restart.take(&engaged(&pattern));
        if broken {
            restart.take(&event(EventKind::Panicked));
        }
        restart.take(&event(ENDS));
        restart.end();
        let kept = state_file::read(&folder.request.path).unwrap();
        assert_eq!(kept.map(|saved| saved.resume), is_left.then_some(pattern));
    }
}

/// With two sensors the other's switch, off, may be delivered while the owner of
/// the switch is silent: before the interruption, and first after the start.
#[test]
fn only_the_owner_of_the_switch_switches_off() {
    let folder = Folder::new(RestartMode::Warm);
    let (restart, _) = Restart::begin(folder.request.clone());
    let mut restart = restart.unwrap();
    restart.take(&switched(&engaged(&FLOWN), 0, Switch::On));
    let mut pattern = FLOWN;
    pattern.progress.mode = Mode::TimedPattern;
    restart.take(&switched(&engaged(&pattern), 1, Switch::Off));
    restart.take(&event(EventKind::Panicked));
    restart.end();
    let saved = state_file::read(&folder.request.path).unwrap().unwrap();
    let owners = SavedSwitch {
        on: true,
        source: 0,
    };
    assert_eq!((saved.switch, saved.resume), (owners, pattern));

    let standby = Message::Tick(Record::new(Tick::default(), State::Standby));
    let mut recovery = Recovery::new(saved, None);
    let mut next = |source, switch| {
        recovery.take(&switched(&standby, source, switch));
        recovery.next(BootInstant::now(), Duration::from_secs(60))
    };
    assert!(matches!(next(1, Switch::Off), Next::Command(_)));
    assert!(matches!(next(0, Switch::On), Next::Command(_)));
    // A single reading may be wrong.
    assert!(matches!(next(0, Switch::Off), Next::Command(_)));
    assert!(matches!(next(0, Switch::On), Next::Command(_)));
    assert!(matches!(next(0, Switch::Off), Next::Command(_)));
    let Next::NotRecovered(why) = next(0, Switch::Off) else {
        panic!("it was switched off")
    };
    assert!(why.contains("it was switched off since"), "{why}");
}
