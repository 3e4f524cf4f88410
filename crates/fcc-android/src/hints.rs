//! Performance hints for the loop's thread, where Android offers them.
//!
//! The loop's thread calls nothing of it: the flight's thread begins a session for it,
//! and reports what the records say that its ticks took. A report is a message to
//! another process, and may wait.

use std::sync::Arc;
use std::time::Duration;

use fcc_fixed_wing::{Autopilot, AutopilotCommand};
use fcc_flight::flight::{Access, Facts, FlightTime, Observer, Reports};
use fcc_phone::HintSession;
use fcc_telemetry::FlightRecord;

use crate::live::{Live, ShownHints};

/// The part of the period that a tick should take at most.
///
/// A tick takes some hundredths of it on the slowest processor, so the period itself, or
/// the budget of a tick, would tell the system to leave it slow. What counts is the time
/// from the sensors to the actuators, which is dead time of the control loops. They have
/// half a period of it in any case, because each output is held for a period (Åström and
/// Wittenmark, Computer-Controlled Systems, 1997): a tick should not add more than a tenth
/// of that.
const PART_OF_PERIOD: u32 = 20;

/// The session of a flight.
pub(crate) struct HintingObserver {
    live: Arc<Live>,
    session: Option<HintSession>,
    shown: ShownHints,
}

impl HintingObserver {
    pub(crate) fn new(live: &Arc<Live>) -> Self {
        Self {
            live: Arc::clone(live),
            session: None,
            shown: ShownHints::default(),
        }
    }

    /// There is no session any more.
    fn close(&mut self, why: &str) {
        if self.session.take().is_some() {
            self.shown.session = false;
            self.shown.why = Some(why.to_owned());
            self.live.show_hints(&self.shown);
        }
    }
}

impl Observer<Autopilot> for HintingObserver {
    fn begin(&mut self, facts: &Facts<'_>, _: &mut Reports) {
        // In lockstep there is no thread.
        let Some(granted) = facts.granted else {
            return;
        };
        let target = Duration::from_secs_f64(1.0 / facts.rate_hz) / PART_OF_PERIOD;
        let session = HintSession::begin(granted.thread, target);
        self.shown = ShownHints {
            session: session.is_ok(),
            why: session.as_ref().err().map(ToString::to_string),
            target_us: target.as_secs_f64() * 1e6,
            reports: 0,
        };
        self.session = session.ok();
        self.live.show_hints(&self.shown);
    }

    fn record(&mut self, record: &FlightRecord, _: &FlightTime) {
        if let Some(session) = &mut self.session {
            session.worked(Duration::from_nanos(record.stages.total_ns));
        }
    }

    fn poll(&mut self, _: &mut Access<'_, AutopilotCommand>) {
        match self.session.as_mut().map(HintSession::report) {
            None | Some(Ok(false)) => {}
            Some(Ok(true)) => {
                self.shown.reports += 1;
                self.live.show_hints(&self.shown);
            }
            Some(Err(why)) => self.close(&why.to_string()),
        }
    }

    fn stopping(&mut self) {
        self.close("the loop has ended");
    }
}

impl Drop for HintingObserver {
    /// After a panic of the flight's thread nothing else ends it.
    fn drop(&mut self) {
        self.close("the flight has ended");
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::{Mutex, MutexGuard, PoisonError};
    use std::thread;
    use std::time::Instant;

    use android::loaded::{hint_sessions, tell};
    use fcc_runtime::THREAD_NAME;
    use serde_json::{Value, json};

    use super::*;
    use crate::computer::Computer;
    use crate::listener::Notifier;

    /// The fake library of this process, which does one thing at a time.
    fn fake() -> MutexGuard<'static, ()> {
        static FAKE: Mutex<()> = Mutex::new(());
        let guard = FAKE.lock().unwrap_or_else(PoisonError::into_inner);
        tell(&json!({"performance_hints": {}}));
        guard
    }

    fn eventually<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
        let patience = Instant::now() + Duration::from_secs(20);
        while Instant::now() < patience {
            if let Some(found) = found() {
                return found;
            }
            thread::sleep(Duration::from_millis(10));
        }
        panic!("not within 20 s: {what}");
    }

    /// The loop's thread, by its name: `proc_pid_task(5)`.
    fn loop_thread() -> Option<i32> {
        let tasks = fs::read_dir("/proc/self/task").unwrap();
        tasks.filter_map(Result::ok).find_map(|task| {
            let name = fs::read_to_string(task.path().join("comm")).ok()?;
            let is_loop = name.trim() == THREAD_NAME;
            is_loop.then(|| task.file_name().to_str()?.parse().ok())?
        })
    }

    fn hints(computer: &Computer) -> Value {
        state(computer)["performance_hints"].take()
    }

    fn state(computer: &Computer) -> Value {
        serde_json::from_str(&computer.state()).unwrap()
    }

    fn tick(computer: &Computer) -> u64 {
        state(computer)["now"]["tick"].as_u64().unwrap_or_default()
    }

    #[test]
    fn a_flight_has_a_session_for_its_loop_or_says_why_not() {
        let _fake = fake();
        let folder = tempfile::tempdir().unwrap();
        let text = "[built-in]\n[realtime]\nlock_memory = false\n".to_owned();
        let recordings = folder.path().to_owned();
        let package = "fcc.hints".to_owned();
        let computer = Computer::create(text, recordings, package, Notifier::default()).unwrap();
        assert_eq!(hints(&computer), Value::Null);

        computer.start().unwrap();
        let thread = eventually("the loop runs", loop_thread);
        eventually("three reports", || {
            (hints(&computer)["reports"].as_u64()? >= 3).then_some(())
        });
        let session = hint_sessions(thread).pop().unwrap();
        // A twentieth of 25 ms.
        assert_eq!(session["target_ns"], 1_250_000);
        assert_eq!(hints(&computer)["target_us"], 1_250.0);
        assert_eq!(hints(&computer)["session"], true);
        assert_eq!(session["is_closed"], false);
        computer.stop();
        let session = hint_sessions(thread).pop().unwrap();
        assert_eq!(session["is_closed"], true);
        assert_eq!(session["wrong_reports"], 0);
        assert!(session["reports"].as_u64() >= Some(3));
        assert!(session["shortest_ns"].as_i64() > Some(0));
        assert!(session["longest_ns"].as_i64() < Some(1_000_000_000));
        assert_eq!(hints(&computer)["session"], false);
        assert_eq!(hints(&computer)["why"], "the loop has ended");

        let refusals = [
            (
                json!({"refuses": true}),
                "Android refused a session for the thread",
            ),
            (json!({"preferred_ns": -1}), "not offered by this phone"),
            // `EPIPE`, at the first report.
            (
                json!({"answer": 32}),
                "Android refused a report: Broken pipe",
            ),
        ];
        for (how, why) in refusals {
            tell(&json!({"performance_hints": how}));
            computer.start().unwrap();
            eventually("why there is no session", || {
                let shown = hints(&computer);
                let is_so = shown["why"].as_str()?.starts_with(why);
                (is_so && shown["session"] == false).then_some(())
            });
            let sessions = hint_sessions(loop_thread().unwrap());
            assert!(sessions.iter().all(|session| session["is_closed"] == true));
            let seen = tick(&computer);
            eventually("it flies on", || (tick(&computer) > seen + 5).then_some(()));
            computer.stop();
        }
    }

    /// A panic of the flight's thread drops its observers.
    #[test]
    fn a_session_ends_with_its_observer() {
        let _fake = fake();
        let live = Arc::new(Live::new(Vec::new()));
        let thread = fcc_timer::realtime::this_thread();
        let granted = fcc_timer::RealtimeGranted {
            thread,
            ..fcc_timer::RealtimeGranted::default()
        };
        let facts = Facts {
            rate_hz: 100.0,
            timer: "manual",
            sensors: &[],
            actuators: &[],
            started_unix_ns: 0,
            clock_offset_ns: 0,
            pace: fcc_flight::flight::Pace::RealTime,
            granted: Some(&granted),
        };
        let mut observer = HintingObserver::new(&live);
        observer.begin(&facts, &mut Reports::default());
        let is_closed = || {
            hint_sessions(thread)
                .pop()
                .map(|session| session["is_closed"].clone())
        };
        assert_eq!(is_closed(), Some(json!(false)));
        drop(observer);
        assert_eq!(is_closed(), Some(json!(true)));
    }
}
