//! What the trait `Timer` promises, asked of every timer.
//!
//! Each promise is one function; the macro at the end runs it on each timer.
//! A machine may wake a thread as late as it likes: nothing here asserts that
//! something happened soon enough.
#![cfg(test)]

mod early;
mod interruption;

use std::thread;
use std::time::Duration;

use early::{
    Early, a_long_warm_up_is_a_late_tick, a_tick_that_ends_within_the_margin_loses_no_deadline,
    a_warm_up_is_followed_by_its_deadline, early_wake_can_be_disabled,
    the_margin_and_the_spin_are_reported,
};
use fcc_conformance::allocator_calls;
use fcc_timer::{
    Expiry, ManualTimer, Nanosleep, PosixTimer, Relief, Timer, TimerError, TimerFd, TimingStats,
};

const PERIOD: Duration = Duration::from_millis(4);
const PERIOD_NS: i64 = 4_000_000;

/// A timer on which a test can let time pass.
trait Subject: Timer + Sized + 'static {
    /// How much later than `start` its grid may begin, so that the kernel's
    /// ticks fall beside its deadlines.
    const GRID_LATER_NS: i64 = 0;

    fn make(period: Duration) -> Result<Self, TimerError>;

    /// Spends time as a tick's work does. No less than asked for.
    fn work(&mut self, time: Duration) {
        thread::sleep(time);
    }
}

impl Subject for TimerFd {
    fn make(period: Duration) -> Result<Self, TimerError> {
        Self::new(period)
    }
}

impl Subject for PosixTimer {
    fn make(period: Duration) -> Result<Self, TimerError> {
        Self::new(period)
    }
}

impl Subject for Nanosleep {
    fn make(period: Duration) -> Result<Self, TimerError> {
        Self::new(period)
    }
}

impl Subject for ManualTimer {
    fn make(period: Duration) -> Result<Self, TimerError> {
        Self::new(period)
    }

    fn work(&mut self, time: Duration) {
        self.advance(time);
    }
}

fn started<T: Subject>() -> T {
    let mut timer = T::make(PERIOD).unwrap();
    timer.start().unwrap();
    timer
}

fn the_grid_begins_at_the_start_and_is_kept_to_the_nanosecond<T: Subject>() {
    let mut timer = T::make(PERIOD).unwrap();
    let before_ns = timer.now_ns();
    timer.start().unwrap();
    let after_ns = timer.now_ns();
    let first = timer.wait().unwrap();
    let start_ns = first.scheduled_ns - first.number as i64 * PERIOD_NS;
    assert!((before_ns..=after_ns + T::GRID_LATER_NS).contains(&start_ns));
    for _ in 0..25 {
        let expiry = timer.wait().unwrap();
        assert_eq!(
            expiry.scheduled_ns,
            start_ns + expiry.number as i64 * PERIOD_NS
        );
    }
}

fn numbers_follow_each_other_but_for_the_missed<T: Subject>() {
    let mut timer = started::<T>();
    let mut before = timer.wait().unwrap();
    assert_eq!(before.number, 1 + before.missed);
    for _ in 0..25 {
        before = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
    }
}

/// A tick of 1.2 periods: the deadline that passed in it is skipped, and none
/// when that ends. A delayed machine misses more.
fn a_relieved_timer_skips_deadlines_that_have_passed<T: Subject>() {
    let mut timer = started::<T>();
    let mut before = timer.wait().unwrap();
    timer.relieve(Relief::Skip).unwrap();
    for _ in 0..5 {
        timer.work(PERIOD * 6 / 5);
        let expiry = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
        assert!(expiry.missed >= 1, "{expiry:?}");
        assert!(expiry.used_ns >= PERIOD_NS as u64 * 6 / 5, "{expiry:?}");
        assert_eq!(expiry.early_wake_ns, 0);
        before = expiry;
    }
    timer.relieve(Relief::None).unwrap();
    for _ in 0..5 {
        before = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
    }
}

fn no_wait_returns_before_its_deadline<T: Subject>() {
    let mut timer = started::<T>();
    for _ in 0..25 {
        let expiry = timer.wait().unwrap();
        let returned_ns = timer.now_ns();
        assert!(expiry.woke_ns >= expiry.scheduled_ns, "{expiry:?}");
        assert!(returned_ns >= expiry.woke_ns, "{expiry:?}");
    }
}

fn a_long_tick_misses_deadlines_and_keeps_the_phase<T: Subject>() {
    let mut timer = started::<T>();
    let before = timer.wait().unwrap();
    timer.work(PERIOD * 7 / 2);
    let resumed_ns = timer.now_ns();
    let late = timer.wait().unwrap();
    let after = timer.wait().unwrap();

    // At least 3.5 periods after a deadline, three more have passed: two are
    // missed and the third is served late.
    assert!(late.missed >= 2, "{late:?}");
    assert_follows(late, before, PERIOD_NS);
    // It is the latest: none of those before the wait is left over.
    assert!(late.scheduled_ns > resumed_ns - PERIOD_NS, "{late:?}");
    // And the next is on the same grid again.
    assert_follows(after, late, PERIOD_NS);
}

fn waiting_before_the_start_is_an_error<T: Subject>() {
    let mut timer = T::make(PERIOD).unwrap();
    assert!(matches!(timer.wait(), Err(TimerError::NotStarted)));
    timer.start().unwrap();
    timer.wait().unwrap();
}

fn starting_again_begins_a_new_grid<T: Subject>() {
    let mut timer = started::<T>();
    timer.wait().unwrap();
    timer.work(PERIOD * 5 / 2);
    let restart_ns = timer.now_ns();
    timer.start().unwrap();
    let first = timer.wait().unwrap();
    assert_eq!(first.number, 1 + first.missed);
    assert!(first.scheduled_ns >= restart_ns + PERIOD_NS, "{first:?}");
}

fn bad_periods_are_refused<T: Subject>() {
    for bad in [
        Duration::ZERO,
        Duration::from_micros(9),
        Duration::from_secs(3601),
        Duration::MAX,
    ] {
        match T::make(bad) {
            Err(TimerError::Period(period)) => assert_eq!(period, bad),
            _ => panic!("{bad:?} was not refused"),
        }
    }
    for good in [Duration::from_micros(10), Duration::from_secs(3600)] {
        assert_eq!(T::make(good).unwrap().period(), good);
    }
}

fn waiting_and_recording_allocate_nothing<T: Subject>() {
    let mut timer = started::<T>();
    let mut stats = TimingStats::new(PERIOD).unwrap();
    let ((), calls) = allocator_calls(|| {
        for _ in 0..10 {
            let expiry = timer.wait().unwrap();
            stats.record(&expiry);
            timer.now_ns();
        }
        timer.work(PERIOD * 7 / 2);
        stats.record(&timer.wait().unwrap());
    });
    assert_eq!(calls, 0);
    assert_eq!(stats.summary().ticks, 11);
}

/// A timer made here and run there, as the loop's is.
fn a_timer_runs_in_a_thread_it_was_not_made_in<T: Subject>() {
    let mut timer: Box<dyn Timer> = Box::new(T::make(PERIOD).unwrap());
    thread::spawn(move || {
        timer.start().unwrap();
        timer.wait().unwrap();
    })
    .join()
    .unwrap();
}

fn two_timers_in_one_thread_do_not_disturb_each_other<T: Subject>() {
    let mut quick = started::<T>();
    let mut slow = T::make(PERIOD * 3).unwrap();
    slow.start().unwrap();
    let mut quick_before = quick.wait().unwrap();
    let mut slow_before = slow.wait().unwrap();
    for _ in 0..5 {
        quick_before = assert_follows(quick.wait().unwrap(), quick_before, PERIOD_NS);
        slow_before = assert_follows(slow.wait().unwrap(), slow_before, 3 * PERIOD_NS);
    }
}

/// Asserts that an expiry is on the grid of the one before.
fn assert_follows(expiry: Expiry, before: Expiry, period_ns: i64) -> Expiry {
    assert_eq!(expiry.number, before.number + 1 + expiry.missed);
    assert_eq!(
        expiry.scheduled_ns,
        before.scheduled_ns + (1 + expiry.missed as i64) * period_ns
    );
    assert!(expiry.woke_ns >= expiry.scheduled_ns, "{expiry:?}");
    expiry
}

fn signals_do_not_end_a_wait<T: Subject>() {
    let period = Duration::from_millis(40);
    let mut timer = T::make(period).unwrap();
    timer.start().unwrap();
    let interruptions = interruption::of_this_thread_during(|handled| {
        let mut before = timer.wait().unwrap();
        // On a busy machine it takes a while until somebody interrupts.
        for wait in 0..1_000 {
            before = assert_follows(timer.wait().unwrap(), before, period.as_nanos() as i64);
            if wait >= 1 && handled() > 0 {
                break;
            }
        }
    });
    assert!(interruptions > 0);
}

macro_rules! promise {
    ($module:ident, $timer:ty: $($promise:ident)*) => {
        mod $module {
            $(
                #[test]
                fn $promise() {
                    super::$promise::<$timer>();
                }
            )*
        }
    };
}

macro_rules! conformance {
    ($module:ident, $timer:ty $(, $more:ident)*) => {
        promise! { $module, $timer:
            the_grid_begins_at_the_start_and_is_kept_to_the_nanosecond
            numbers_follow_each_other_but_for_the_missed
            no_wait_returns_before_its_deadline
            a_long_tick_misses_deadlines_and_keeps_the_phase
            a_relieved_timer_skips_deadlines_that_have_passed
            waiting_before_the_start_is_an_error
            starting_again_begins_a_new_grid
            bad_periods_are_refused
            waiting_and_recording_allocate_nothing
            a_timer_runs_in_a_thread_it_was_not_made_in
            two_timers_in_one_thread_do_not_disturb_each_other
            $($more)*
        }
    };
}

conformance!(timerfd, super::TimerFd, signals_do_not_end_a_wait);
conformance!(posix, super::PosixTimer, signals_do_not_end_a_wait);
conformance!(nanosleep, super::Nanosleep, signals_do_not_end_a_wait);
conformance!(manual, super::ManualTimer);
conformance!(
    early_timerfd,
    super::Early<super::TimerFd>,
    signals_do_not_end_a_wait,
    the_margin_and_the_spin_are_reported,
    a_warm_up_is_followed_by_its_deadline,
    early_wake_can_be_disabled,
    a_long_warm_up_is_a_late_tick,
    a_tick_that_ends_within_the_margin_loses_no_deadline
);
conformance!(
    early_posix,
    super::Early<super::PosixTimer>,
    signals_do_not_end_a_wait,
    the_margin_and_the_spin_are_reported,
    a_warm_up_is_followed_by_its_deadline,
    early_wake_can_be_disabled,
    a_long_warm_up_is_a_late_tick,
    a_tick_that_ends_within_the_margin_loses_no_deadline
);
conformance!(
    early_nanosleep,
    super::Early<super::Nanosleep>,
    signals_do_not_end_a_wait,
    the_margin_and_the_spin_are_reported,
    a_warm_up_is_followed_by_its_deadline,
    early_wake_can_be_disabled,
    a_long_warm_up_is_a_late_tick,
    a_tick_that_ends_within_the_margin_loses_no_deadline
);
