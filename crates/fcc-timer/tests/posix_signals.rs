//! The POSIX timer's signals: taken and given back, and nobody else's counted.
#![cfg(test)]

use std::fs;
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use fcc_timer::{PosixTimer, Timer, TimerError};

const PERIOD: Duration = Duration::from_millis(4);

/// One test takes all signals that there are.
static SIGNALS: Mutex<()> = Mutex::new(());

/// The signals that the calling thread blocks, bit `n - 1` for signal `n`.
fn blocked() -> u64 {
    let status = fs::read_to_string("/proc/thread-self/status").unwrap();
    let set = status
        .lines()
        .find_map(|line| line.strip_prefix("SigBlk:"))
        .unwrap();
    u64::from_str_radix(set.trim(), 16).unwrap()
}

fn started() -> PosixTimer {
    let mut timer = PosixTimer::new(PERIOD).unwrap();
    timer.start().unwrap();
    timer
}

#[test]
fn one_real_time_signal_is_blocked_while_the_timer_runs() {
    let _signals = SIGNALS.lock();
    let before = blocked();
    let timer = started();
    let of_timer = blocked() & !before;
    assert_eq!(of_timer.count_ones(), 1);
    // Real-time signals are 32 to 64 (signal(7)).
    assert!(of_timer.trailing_zeros() + 1 >= 32);
    // Expired and never waited for: the signal is queued, and would end the
    // process if it were let through.
    thread::sleep(2 * PERIOD);
    drop(timer);
    assert_eq!(blocked(), before);
}

#[test]
fn a_signal_from_elsewhere_is_no_expiry() {
    let _signals = SIGNALS.lock();
    let before = blocked();
    let mut timer = PosixTimer::new(Duration::from_millis(60)).unwrap();
    timer.start().unwrap();
    let signal = (blocked() & !before).trailing_zeros() + 1;
    for _ in 0..3 {
        send_to_this_thread(signal as i32);
    }
    let expiry = timer.wait().unwrap();
    assert_eq!(expiry.number, 1 + expiry.missed);
    assert!(expiry.woke_ns >= expiry.scheduled_ns, "{expiry:?}");
}

#[allow(unsafe_code)]
fn send_to_this_thread(signal: i32) {
    // SAFETY: the thread is the calling one, and blocks the signal.
    assert_eq!(unsafe { libc::raise(signal) }, 0);
}

#[test]
fn waiting_in_another_thread_than_the_one_of_the_start_is_an_error() {
    let _signals = SIGNALS.lock();
    let mut timer = started();
    let answer = thread::spawn(move || timer.wait().map(|_| ())).join();
    assert!(matches!(answer.unwrap(), Err(TimerError::WrongThread)));
}

#[test]
fn a_timer_may_be_dropped_in_another_thread() {
    let _signals = SIGNALS.lock();
    let timer = started();
    thread::sleep(2 * PERIOD);
    thread::spawn(move || drop(timer)).join().unwrap();
    // The next one may get the signal that is still queued here.
    let mut next = PosixTimer::new(Duration::from_millis(60)).unwrap();
    next.start().unwrap();
    let expiry = next.wait().unwrap();
    assert!(expiry.woke_ns >= expiry.scheduled_ns, "{expiry:?}");
}

#[test]
fn when_all_signals_are_taken_the_next_timer_says_so() {
    let _signals = SIGNALS.lock();
    let mut running = Vec::new();
    let refused = loop {
        let mut timer = PosixTimer::new(PERIOD).unwrap();
        match timer.start() {
            Ok(()) => running.push(timer),
            Err(error) => break error,
        }
        assert!(running.len() <= 33, "more timers than real-time signals");
    };
    assert!(matches!(refused, TimerError::NoSignal));
    assert!(running.len() >= 8, "POSIX promises 8 real-time signals");
    drop(running);
    started();
}
