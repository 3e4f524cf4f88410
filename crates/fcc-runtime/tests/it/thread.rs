//! The loop in a thread of its own, on a real clock. What is asserted is what
//! happens, never how fast.

use std::thread;
use std::time::Duration;

use crate::bench::{Stage, Stub, parts};
use fcc_core::framework::{Sensor, SensorFault, State, Tick};
use fcc_runtime::{
    Ending, Link, Loop, LoopCommand, LoopConfig, LoopHandle, LoopReport, Message, Parts, SpawnError,
};
use fcc_timer::{CpuRequest, EarlyWake, RealtimeRequest, Strictness, TimerKind};

/// 500 Hz.
const PERIOD: Duration = Duration::from_millis(2);

fn spawned(stage: &Stage) -> (LoopHandle, Link<Stub>) {
    let timed = Parts {
        timer: TimerKind::Timerfd.build(PERIOD).unwrap(),
        ..parts(stage)
    };
    let (this, link) = Loop::new(timed, &LoopConfig::default()).unwrap();
    (this.spawn().unwrap(), link)
}

/// Reads until a record shows this state.
fn wait_for(link: &mut Link<Stub>, state: State) {
    loop {
        match link.messages.receive() {
            Some(Message::Tick(record)) if record.state == state => return,
            Some(_) => {}
            None => {
                assert!(!link.messages.is_over(), "over before {state}");
                thread::sleep(PERIOD);
            }
        }
    }
}

#[test]
fn commands_in_and_records_out() {
    let stage = Stage::default();
    let (handle, mut link) = spawned(&stage);
    wait_for(&mut link, State::Standby);
    link.commands.send(LoopCommand::Engage).unwrap();
    wait_for(&mut link, State::Engaged);
    assert!(!handle.is_finished());
    link.commands.send(LoopCommand::Stop).unwrap();
    wait_for(&mut link, State::Stopped);
    let report = handle.join();
    assert!(matches!(report.ending, Ending::StopCommand));
    assert!(report.released);
    assert!(report.granted.is_some());
    assert_eq!(report.timer, "timerfd");
    assert_eq!(stage.log().held, [false, false]);
    assert_eq!(report.timing.ticks, report.ticks);
    assert!(report.cpu_time > Duration::ZERO);
}

#[test]
fn the_stop_flag_ends_it_from_another_thread() {
    let stage = Stage::default();
    let (handle, mut link) = spawned(&stage);
    link.commands.send(LoopCommand::Engage).unwrap();
    wait_for(&mut link, State::Engaged);
    let stop = link.stop.clone();
    thread::spawn(move || stop.stop()).join().unwrap();
    assert!(matches!(handle.join().ending, Ending::StopFlag));
    assert_eq!(stage.log().held, [false, false]);
}

#[test]
fn a_dropped_handle_releases_control() {
    let stage = Stage::default();
    let (handle, mut link) = spawned(&stage);
    link.commands.send(LoopCommand::Engage).unwrap();
    wait_for(&mut link, State::Engaged);
    drop(handle);
    assert_eq!(stage.log().held, [false, false]);
    wait_for(&mut link, State::Stopped);
    assert!(link.messages.receive().is_none());
    assert!(link.messages.is_over());
}

#[test]
fn a_panic_in_its_thread_is_in_the_report() {
    let stage = Stage::default();
    let (handle, mut link) = spawned(&stage);
    link.commands.send(LoopCommand::Engage).unwrap();
    wait_for(&mut link, State::Engaged);
    stage.set(|s| s.panic_in = Some("control"));
    let Ending::Panicked(words) = handle.join().ending else {
        panic!("ended otherwise");
    };
    assert!(
        words.starts_with("scripted panic in control (at ") && words.contains("bench/mod.rs:"),
        "{words}"
    );
    assert_eq!(stage.log().held, [false, false]);
}

#[test]
fn a_required_request_that_is_denied_starts_nothing() {
    let stage = Stage::default();
    let config = LoopConfig {
        realtime: RealtimeRequest {
            // No machine has this many.
            cpu: Some(CpuRequest::Number(1_000_000)),
            strictness: Strictness::Strict,
            ..RealtimeRequest::default()
        },
        ..LoopConfig::default()
    };
    let (this, mut link) = Loop::new(parts(&stage), &config).unwrap();
    let refused = this.spawn().unwrap_err();
    assert!(matches!(refused, SpawnError::Realtime(_)), "{refused}");
    assert!(!stage.log().calls.contains(&"sample"));
    while let Some(message) = link.messages.receive() {
        assert!(matches!(message, Message::Event(_)), "a tick was performed");
    }
}

/// A sensor that allocates memory in one tick, as none should.
struct Greedy {
    tick: u64,
    kept: Vec<u8>,
}

impl<M> Sensor<M> for Greedy {
    fn sample(&mut self, tick: &Tick, _: &mut M) -> Result<(), SensorFault> {
        // More than the C library takes from memory that was freed before,
        // which has its pages (32 MiB, M_MMAP_THRESHOLD in mallopt(3)).
        const BYTES: usize = 64 << 20;
        const PAGES: usize = 64;
        if tick.number >= self.tick && self.kept.is_empty() {
            self.kept = vec![0; BYTES];
            for byte in self.kept.iter_mut().step_by(4096).take(PAGES) {
                *byte = 1;
            }
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "greedy"
    }
}

#[test]
fn page_faults_are_in_the_record_of_their_tick() {
    const GREEDY: u64 = 20;
    let stage = Stage::default();
    let mut greedy = Parts {
        timer: TimerKind::Timerfd.build(PERIOD).unwrap(),
        ..parts(&stage)
    };
    greedy.sensors.push(Box::new(Greedy {
        tick: GREEDY,
        kept: Vec::new(),
    }));
    let (this, mut link) = Loop::new(greedy, &LoopConfig::default()).unwrap();
    let handle = this.spawn().unwrap();
    // By tick number: the faults counted until then.
    let mut counted = Vec::new();
    while counted.last().is_none_or(|(number, _)| *number < GREEDY) {
        match link.messages.receive() {
            Some(Message::Tick(record)) => counted.push((record.tick.number, record.page_faults)),
            Some(_) => {}
            None => thread::sleep(PERIOD),
        }
    }
    handle.stop();
    let report = handle.join();
    let faults: Vec<u64> = counted.iter().map(|(_, faults)| *faults).collect();
    assert!(faults.is_sorted());
    // Fewer than one a page: the kernel may hand out larger ones.
    if let [.., before, after] = faults[..] {
        assert!(after > before, "{counted:?}");
    }
    assert!(report.page_faults.unwrap() >= *faults.last().unwrap());
}

#[test]
fn the_margin_of_an_early_timer_is_in_the_record() {
    let stage = Stage::default();
    let early = EarlyWake::default();
    let timed = Parts {
        timer: TimerKind::Nanosleep.build_early(PERIOD, &early).unwrap(),
        ..parts(&stage)
    };
    let (this, mut link) = Loop::new(timed, &LoopConfig::default()).unwrap();
    let handle = this.spawn().unwrap();
    let margin_ns = loop {
        match link.messages.receive() {
            Some(Message::Tick(record)) => break record.early_wake_ns,
            Some(_) => {}
            None => thread::sleep(PERIOD),
        }
    };
    handle.stop();
    let timing = handle.join().timing;
    // It begins with the most it may be.
    assert_eq!(margin_ns, 250_000);
    assert_eq!(timing.early_wake_max_us, 250.0);
    assert!(timing.early_wake_us >= 20.0);
}

/// Runs a loop on a timer that wakes early if the thread has a real-time
/// priority; its longest margin, µs, and its report.
fn margin_with(priority: Option<u8>) -> (f64, LoopReport) {
    let stage = Stage::default();
    let early = EarlyWake::default();
    let timed = Parts {
        timer: TimerKind::Timerfd.build_early(PERIOD, &early).unwrap(),
        ..parts(&stage)
    };
    let config = LoopConfig {
        early_wake_needs_priority: true,
        realtime: RealtimeRequest {
            priority,
            ..RealtimeRequest::default()
        },
        ..LoopConfig::default()
    };
    let (this, link) = Loop::new(timed, &config).unwrap();
    let handle = this.spawn().unwrap();
    thread::sleep(5 * PERIOD);
    link.stop.stop();
    let report = handle.join();
    (report.timing.early_wake_max_us, report)
}

#[test]
fn early_wake_that_needs_a_priority_is_off_without_one_and_reported() {
    let denied = |report: &LoopReport| -> Vec<String> {
        let granted = report.granted.as_ref().unwrap();
        granted
            .denied
            .iter()
            .map(|one| one.request.clone())
            .collect()
    };
    // No priority was requested: nothing is denied.
    let (margin_us, report) = margin_with(None);
    assert_eq!(margin_us, 0.0);
    assert!(denied(&report).is_empty());

    let (margin_us, report) = margin_with(Some(10));
    if report.granted.as_ref().unwrap().priority > 0 {
        assert_eq!(margin_us, 250.0);
        assert!(denied(&report).is_empty());
    } else {
        assert_eq!(margin_us, 0.0);
        assert_eq!(denied(&report), ["SCHED_FIFO priority 10", "early wake"]);
    }
}
