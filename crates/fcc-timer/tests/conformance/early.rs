//! What a timer that wakes early also promises: its margin, its spin and its
//! warm-up.

use std::time::Duration;

use fcc_timer::{
    EarlyWake, Expiry, Nanosleep, PosixTimer, Relief, Timer, TimerError, TimerFd, Wake,
};

use crate::{PERIOD, PERIOD_NS, Subject, assert_follows, started};

/// A timer that wakes early. The margin is long, so that a tick's work often
/// ends within it.
pub(crate) struct Early<T>(T);

const EARLY: EarlyWake = EarlyWake {
    min: Duration::from_micros(100),
    max: Duration::from_millis(1),
    quantile: 0.99,
    guard: Duration::from_micros(50),
    cpu_cap: 0.5,
};

macro_rules! early {
    ($($timer:ty)*) => {$(
        impl Subject for Early<$timer> {
            const GRID_LATER_NS: i64 = PERIOD_NS;

            fn make(period: Duration) -> Result<Self, TimerError> {
                <$timer>::new(period)?.waking_early(&EARLY).map(Self)
            }
        }
    )*};
}

early!(TimerFd PosixTimer Nanosleep);

impl<T: Timer> Timer for Early<T> {
    fn start(&mut self) -> Result<(), TimerError> {
        self.0.start()
    }

    fn wait(&mut self) -> Result<Expiry, TimerError> {
        self.0.wait()
    }

    fn wait_or_warm_up(&mut self) -> Result<Wake, TimerError> {
        self.0.wait_or_warm_up()
    }

    fn disable_early_wake(&mut self) {
        self.0.disable_early_wake();
    }

    fn relieve(&mut self, relief: Relief) -> Result<(), TimerError> {
        self.0.relieve(relief)
    }

    fn period(&self) -> Duration {
        self.0.period()
    }

    fn now_ns(&self) -> i64 {
        self.0.now_ns()
    }

    fn name(&self) -> &'static str {
        self.0.name()
    }
}

/// Margin and spin of a wait are within their limits.
pub(crate) fn the_margin_and_the_spin_are_reported<T: Subject>() {
    let mut timer = started::<T>();
    for _ in 0..100 {
        let expiry = timer.wait().unwrap();
        assert!(
            (100_000..=1_000_000).contains(&expiry.early_wake_ns),
            "{expiry:?}"
        );
        assert!(expiry.kernel_lateness_ns >= 0, "{expiry:?}");
        assert!(expiry.spun_ns <= expiry.early_wake_ns, "{expiry:?}");
    }
}

/// A warm-up names the next deadline; then that deadline comes, or a later one if
/// the thread was interrupted, and no second warm-up before it.
pub(crate) fn a_warm_up_is_followed_by_its_deadline<T: Subject>() {
    let mut timer = started::<T>();
    let mut warmed_up = 0;
    let mut before = timer.wait().unwrap();
    for tick in 0..2_000 {
        if tick >= 100 && warmed_up > 0 {
            break;
        }
        let mut wake = timer.wait_or_warm_up().unwrap();
        if let Wake::WarmUp(expected) = wake {
            warmed_up += 1;
            assert!(expected.number > before.number, "{expected:?}");
            wake = timer.wait_or_warm_up().unwrap();
            let Wake::Deadline(expiry) = wake else {
                panic!("two warm-ups for one deadline");
            };
            let passed = expiry.number as i64 - expected.number as i64;
            assert!(passed >= 0, "{expected:?} {expiry:?}");
            assert_eq!(
                expiry.scheduled_ns,
                expected.scheduled_ns + passed * PERIOD_NS
            );
        }
        let (Wake::Deadline(expiry) | Wake::WarmUp(expiry)) = wake;
        before = assert_follows(expiry, before, PERIOD_NS);
    }
    // On a busy machine some wake-ups leave no time for it.
    assert!(warmed_up > 0);
}

/// A warm-up that takes longer than the time left misses the deadlines that
/// passed, like any long tick; a plain wait after it returns the deadline.
pub(crate) fn a_long_warm_up_is_a_late_tick<T: Subject>() {
    let mut timer = started::<T>();
    let mut before = timer.wait().unwrap();
    // On a busy machine some wake-ups leave no time for one.
    for _ in 0..2_000 {
        match timer.wait_or_warm_up().unwrap() {
            Wake::Deadline(expiry) => before = assert_follows(expiry, before, PERIOD_NS),
            Wake::WarmUp(expected) => {
                timer.work(PERIOD * 5 / 2);
                let late = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
                assert!(late.missed >= 2, "{late:?}");
                assert!(late.number >= expected.number + 2, "{late:?}");
                return;
            }
        }
    }
    panic!("no warm-up in 2000 deadlines");
}

/// Without early wake it is a plain timer, with deadlines as before.
pub(crate) fn early_wake_can_be_disabled<T: Subject>() {
    let mut timer = T::make(PERIOD).unwrap();
    timer.disable_early_wake();
    timer.start().unwrap();
    let mut before = timer.wait().unwrap();
    for _ in 0..20 {
        let Wake::Deadline(expiry) = timer.wait_or_warm_up().unwrap() else {
            panic!("a warm-up without early wake");
        };
        assert_eq!((expiry.early_wake_ns, expiry.spun_ns), (0, 0));
        before = assert_follows(expiry, before, PERIOD_NS);
    }
}

/// A tick that ends between an alarm and its deadline: the alarm has gone by,
/// the deadline has not.
pub(crate) fn a_tick_that_ends_within_the_margin_loses_no_deadline<T: Subject>() {
    let mut timer = started::<T>();
    let mut before = timer.wait().unwrap();
    let mut on_time = 0;
    for _ in 0..25 {
        let until_ns = before.scheduled_ns + PERIOD_NS - before.early_wake_ns as i64 / 2;
        while timer.now_ns() < until_ns {
            timer.work(Duration::from_micros(1));
        }
        before = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
        on_time += u64::from(before.missed == 0);
        // Served is the latest deadline: the next one had not come.
        assert!(before.lateness_ns() < PERIOD_NS, "{before:?}");
        before = assert_follows(timer.wait().unwrap(), before, PERIOD_NS);
        assert!(before.lateness_ns() < PERIOD_NS, "{before:?}");
    }
    // Were the alarm that went by waited for, each round would miss one; a busy
    // machine makes some rounds miss one, and no machine all.
    assert!(on_time > 0);
}
