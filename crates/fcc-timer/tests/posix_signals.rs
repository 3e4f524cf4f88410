//! The POSIX timer's signals: taken and given back, and nobody else's counted.
//!
//! A process of its own: signals are of the whole process.
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
    let signal = of_timer.trailing_zeros() + 1;
    assert!(signal >= 32);
    // Expired and never waited for, and sent by somebody else as well: the
    // signals are queued, and would end the process if they were let through.
    thread::sleep(2 * PERIOD);
    for _ in 0..3 {
        send_to_this_thread(signal as i32, libc::SI_QUEUE, 0);
    }
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
    // From a timer that is gone, as kernels before 6.13 leave it behind; from
    // somebody who may even have guessed the value; from raise(3).
    send_to_this_thread(signal as i32, libc::SI_TIMER, 0);
    for value in 0..100 {
        send_to_this_thread(signal as i32, libc::SI_QUEUE, value);
    }
    send_to_this_thread(signal as i32, libc::SI_TKILL, 0);
    let expiry = timer.wait().unwrap();
    assert_eq!(expiry.number, 1 + expiry.missed);
    assert!(expiry.woke_ns >= expiry.scheduled_ns, "{expiry:?}");
}

/// Queues a signal as sigqueue(3) does, but to the calling thread alone and
/// with any origin.
#[allow(unsafe_code)]
fn send_to_this_thread(signal: i32, origin: i32, value: usize) {
    /// What the kernel reads of a `siginfo_t`, which has 128 bytes.
    #[repr(C)]
    struct Info {
        signal: i32,
        errno: i32,
        origin: i32,
        sender: Sender,
        rest: [usize; 16],
    }
    #[repr(C)]
    struct Sender {
        process: i32,
        user: u32,
        value: usize,
    }
    let info = Info {
        signal,
        errno: 0,
        origin,
        sender: Sender {
            process: 0,
            user: 0,
            value,
        },
        rest: [0; 16],
    };
    let (process, thread) = (nix::unistd::getpid(), nix::unistd::gettid());
    // SAFETY: the kernel reads 128 bytes through the pointer, during the call.
    // The signal is blocked in the thread it goes to.
    let answer = unsafe {
        libc::syscall(
            libc::SYS_rt_tgsigqueueinfo,
            process.as_raw(),
            thread.as_raw(),
            signal,
            &raw const info,
        )
    };
    assert_eq!(answer, 0);
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
    // Starting again needs no second signal, and what is given back is free.
    running[0].start().unwrap();
    drop(running);
    started();
}
