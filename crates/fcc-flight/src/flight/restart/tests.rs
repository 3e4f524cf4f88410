//! What is made of a state file that is found at the start.

use fcc_core::flight::guidance::Mode;
use fcc_core::flight::{Setpoints, Surfaces};
use fcc_core::framework::{Event, Tick, Time};
use tempfile::TempDir;

use super::*;

const FLOWN: Resume = Resume {
    progress: Progress {
        mode: Mode::Hold,
        item: 0,
        elapsed_s: 20.0,
        captured: Targets {
            airspeed_mps: 50.0,
            heading_rad: 1.0,
            altitude_m: 900.0,
        },
    },
    surfaces: Surfaces {
        throttle: 0.6,
        elevator: 0.0,
        aileron: 0.0,
        rudder: 0.0,
    },
};

/// A folder with what a flight left.
struct Left {
    folder: TempDir,
    wish: RestartRequest,
}

impl Left {
    fn new(mode: RestartMode) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let wish = RestartRequest {
            mode,
            max_age: Duration::from_secs(60),
            path: folder.path().join("fccd.flight"),
            fingerprint: 7,
        };
        Self { folder, wish }
    }

    /// Leaves a flight that was cut off so many seconds ago.
    fn leave(&self, seconds_ago: u64, change: impl FnOnce(&mut Saved)) {
        let mut at = BootInstant::now().unwrap();
        at.ns = at.ns.saturating_sub(seconds_ago * 1_000_000_000);
        let mut saved = Saved {
            at,
            config: 7,
            switch_on: true,
            take_ups: 0,
            resume: FLOWN,
        };
        change(&mut saved);
        state_file::write(&self.wish.path, &saved).unwrap();
    }

    /// Whether it is to be taken up, and what is said.
    fn found(&self) -> (bool, String) {
        let (restart, words) = Restart::begin(self.wish.clone());
        let restart = restart.expect("there is a place to keep it");
        let taking_up = restart.taking_up.is_some();
        restart.end();
        (taking_up, words.unwrap_or_default())
    }

    fn is_kept(&self) -> bool {
        self.wish.path.exists()
    }
}

#[test]
fn nothing_left_is_nothing_said() {
    for mode in [RestartMode::Cold, RestartMode::Warm] {
        assert_eq!(Left::new(mode).found(), (false, String::new()));
    }
}

#[test]
fn a_young_flight_is_taken_up_where_that_is_wanted() {
    let left = Left::new(RestartMode::Warm);
    left.leave(2, |_| {});
    let (taken, said) = left.found();
    assert!(taken && said.contains("taking it up"), "{said}");
    assert!(left.is_kept(), "until it is decided");
}

#[test]
fn a_cold_restart_says_so_once() {
    let left = Left::new(RestartMode::Cold);
    left.leave(2, |_| {});
    let (taken, said) = left.found();
    assert!(
        !taken && said.contains("restart.mode is \"cold\""),
        "{said}"
    );
    assert_eq!(left.found(), (false, String::new()));
}

#[test]
fn what_cannot_be_trusted_is_not_taken_up() {
    type Change = fn(&mut Saved);
    let reasons: [(&str, u64, Change); 4] = [
        ("longer than restart.max_age_s, 60 s", 61, |_| {}),
        ("before this machine was last started", 2, |saved| {
            saved.at.boot = "another".to_owned();
        }),
        ("another configuration", 2, |saved| saved.config = 8),
        ("taken up 3 times in a row", 2, |saved| saved.take_ups = 3),
    ];
    for (because, seconds_ago, change) in reasons {
        let left = Left::new(RestartMode::Warm);
        left.leave(seconds_ago, change);
        let (taken, said) = left.found();
        assert!(!taken && said.contains(because), "{said}");
        assert!(said.contains("standing by"), "{said}");
        assert!(!left.is_kept());
    }
}

#[test]
fn a_damaged_file_is_said_and_a_foreign_one_is_left_alone() {
    let left = Left::new(RestartMode::Warm);
    fs::write(&left.wish.path, "fccd-flight 2 0\n{").unwrap();
    let (taken, said) = left.found();
    assert!(!taken && said.contains("damaged"), "{said}");

    fs::write(&left.wish.path, "my diary\n").unwrap();
    let (restart, said) = Restart::begin(left.wish.clone());
    assert!(restart.is_none());
    assert!(said.unwrap().contains("no state file of fccd"));
    assert_eq!(fs::read_to_string(&left.wish.path).unwrap(), "my diary\n");
}

#[test]
fn two_daemons_do_not_share_a_file() {
    let left = Left::new(RestartMode::Warm);
    left.leave(2, |_| {});
    let (first, _) = Restart::begin(left.wish.clone());
    let (second, said) = Restart::begin(left.wish.clone());
    assert!(first.is_some() && second.is_none());
    assert!(said.unwrap().contains("another fccd"));
}

#[test]
fn a_place_that_cannot_be_is_said() {
    let mut left = Left::new(RestartMode::Warm);
    fs::write(left.folder.path().join("file"), "").unwrap();
    left.wish.path = left.folder.path().join("file/fccd.flight");
    let (restart, said) = Restart::begin(left.wish.clone());
    assert!(restart.is_none());
    assert!(
        said.unwrap()
            .contains("a restart would not know of this flight")
    );
}

fn event(kind: EventKind<AutopilotCommand>) -> FlightMessage {
    Message::Event(Event {
        tick: 0,
        time: Time::from_nanos(0),
        kind,
    })
}

/// A tick in which this is flown.
fn engaged(resume: &Resume) -> FlightMessage {
    Message::Tick(FlightRecord {
        setpoints: Setpoints {
            guidance: resume.progress,
            ..Setpoints::default()
        },
        outputs: resume.surfaces,
        ..FlightRecord::new(Tick::default(), State::Engaged)
    })
}

const ENDS: EventKind<AutopilotCommand> = EventKind::StateChanged {
    from: State::Engaged,
    to: State::Stopped,
};

/// Mode and progress come from the record; the file has what was flown last.
#[test]
fn what_the_record_says_is_kept_until_the_flight_ends_as_it_should() {
    let mut pattern = FLOWN;
    pattern.progress.mode = Mode::TimedPattern;
    pattern.progress.elapsed_s = 45.0;
    for (broken, is_left) in [(false, false), (true, true)] {
        let left = Left::new(RestartMode::Warm);
        let (restart, _) = Restart::begin(left.wish.clone());
        let mut restart = restart.unwrap();
        restart.take(&engaged(&FLOWN));
        restart.take(&engaged(&pattern));
        if broken {
            restart.take(&event(EventKind::Panicked));
        }
        restart.take(&event(ENDS));
        restart.end();
        let kept = state_file::read(&left.wish.path).unwrap();
        assert_eq!(kept.map(|saved| saved.resume), is_left.then_some(pattern));
    }
}
