//! Phones with performance hints, and without.

use std::thread;
use std::time::Duration;

use android::loaded::{hint_sessions, tell};
use fcc_phone::{HintSession, NoHintSession};
use nix::unistd::gettid;
use serde_json::json;

/// Any time.
const TARGET: Duration = Duration::from_micros(1_250);

fn play(how: &serde_json::Value) {
    tell(&json!({ "performance_hints": how }));
}

/// One after the other: the library that plays has one way of doing it at a time.
#[test]
fn a_phone_is_told_how_long_the_work_took() {
    let own = gettid().as_raw();

    // Every 50 ms at most, and then the longest.
    let mut session = HintSession::begin(own, TARGET).unwrap();
    assert_eq!(session.report(), Ok(false), "nothing was done yet");
    session.worked(Duration::from_micros(30));
    assert_eq!(session.report(), Ok(true));
    for took_us in [20, 90, 40] {
        session.worked(Duration::from_micros(took_us));
        assert_eq!(
            session.report(),
            Ok(false),
            "the phone does not want it yet"
        );
    }
    thread::sleep(Duration::from_millis(60));
    assert_eq!(session.report(), Ok(true));
    thread::sleep(Duration::from_millis(60));
    assert_eq!(session.report(), Ok(false), "nothing was done since");
    let seen = json!({
        "thread": own, "target_ns": 1_250_000, "reports": 2, "shortest_ns": 30_000,
        "longest_ns": 90_000, "wrong_reports": 0, "is_closed": false,
    });
    assert_eq!(hint_sessions(own), [seen]);
    drop(session);
    assert_eq!(hint_sessions(own).last().unwrap()["is_closed"], true);

    // `EPIPE`: the system's service has ended.
    let mut session = HintSession::begin(own, TARGET).unwrap();
    play(&json!({"answer": 32}));
    session.worked(Duration::from_micros(30));
    assert!(matches!(
        session.report(),
        Err(NoHintSession::ReportRefused(_))
    ));
    drop(session);
    assert_eq!(hint_sessions(own).last().unwrap()["is_closed"], true);

    play(&json!({"preferred_ns": -1}));
    let refused = HintSession::begin(own, TARGET).map(drop);
    assert_eq!(refused, Err(NoHintSession::NotSupported));
    play(&json!({"refuses": true}));
    let refused = HintSession::begin(own, TARGET).map(drop);
    assert_eq!(refused, Err(NoHintSession::Refused(own)));

    // A thread of another process, and none.
    play(&json!({}));
    for thread in [1, 0, -1] {
        let refused = HintSession::begin(thread, TARGET).map(drop);
        assert_eq!(refused, Err(NoHintSession::Refused(thread)));
    }
}
