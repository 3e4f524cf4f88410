//! Fault injection for tests. Only in programs built with the feature
//! `fault-injection`.
//!
//! The environment selects the fault:
//! - `FCCD_PANIC_AT_S`: this many seconds after engaging, control panics;
//! - `FCCD_NAN_AT_S`: this many seconds after engaging, control commands NaN;
//! - `FCCD_HANG_AT_S`: this many seconds after engaging, control never returns;
//! - `FCCD_SLOW_AT_S`: this many seconds after engaging, control begins to take
//!   `FCCD_SLOW_MS` longer, in `FCCD_SLOW_TICKS` ticks (all, if not given); with
//!   `FCCD_SLOW_SPINS` it computes for that long, otherwise it sleeps;
//! - `FCCD_BLOCK_AT_S`: this many seconds after the first tick, a sensor
//!   blocks;
//! - `FCCD_RELEASE_FAILS`: the watchdog's release of the controls panics
//!   (`panics`), or never returns (`blocks`);
//! - `FCCD_PAUSE_AT_S`: this many seconds after the loop's start, its messages
//!   are not read, for `FCCD_PAUSE_S` (for ever, if not given).
//!
//! Without these a flight is the same to the last bit as in a program without the
//! feature: control is not replaced, and the sensor that would block measures nothing.
//!
//! Such a program counts the calls of its allocator, too: [`loop_allocator_calls`]. So
//! that a test can show that they would be seen, [`allocate_in_loop`] makes some.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use fcc_conformance::allocator_calls_so_far;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Sensor, SensorFault, Tick, Time};
use fcc_fixed_wing::Autopilot;

use super::control_override::ControlOverride;

/// Injected faults of control.
#[derive(Debug)]
pub(super) struct Faulty {
    panic_at_s: Option<f64>,
    nan_at_s: Option<f64>,
    hang_at_s: Option<f64>,
    slow: Slow,
    engaged_at: Time,
}

/// An injected delay of control.
#[derive(Debug)]
struct Slow {
    at_s: Option<f64>,
    by: Duration,
    spins: bool,
    ticks_left: u64,
}

impl Slow {
    fn from_environment() -> Self {
        Self {
            at_s: number("FCCD_SLOW_AT_S"),
            by: Duration::from_secs_f64(number("FCCD_SLOW_MS").unwrap_or(0.0) * 1e-3),
            spins: number("FCCD_SLOW_SPINS").is_some(),
            ticks_left: number("FCCD_SLOW_TICKS").map_or(u64::MAX, |ticks| ticks as u64),
        }
    }

    fn take_longer(&mut self) {
        if self.ticks_left > 0 {
            self.ticks_left -= 1;
            let begun = Instant::now();
            while self.spins && begun.elapsed() < self.by {
                std::hint::spin_loop();
            }
            thread::sleep(self.by.saturating_sub(begun.elapsed()));
        }
    }
}

static LOOP_ALLOCATOR_CALLS: AtomicU64 = AtomicU64::new(0);

/// How often the thread of the newest flight's loop had called the allocator when its
/// newest tick read the sensors.
pub fn loop_allocator_calls() -> u64 {
    LOOP_ALLOCATOR_CALLS.load(Ordering::Relaxed)
}

static ALLOCATES: AtomicBool = AtomicBool::new(false);

/// Lets the next tick of a loop allocate and free.
pub fn allocate_in_loop() {
    ALLOCATES.store(true, Ordering::Relaxed);
}

/// A sensor without readings that blocks at a given time.
#[derive(Debug)]
pub(super) struct Blocking {
    at_s: Option<f64>,
    began: Time,
}

impl Default for Blocking {
    /// Reads the time of blocking from the environment.
    fn default() -> Self {
        Self {
            at_s: number("FCCD_BLOCK_AT_S"),
            began: Time::NEVER,
        }
    }
}

impl Sensor<Measurements> for Blocking {
    fn sample(&mut self, tick: &Tick, _: &mut Measurements) -> Result<(), SensorFault> {
        if ALLOCATES.swap(false, Ordering::Relaxed) {
            drop(std::hint::black_box(Box::new(0_u8)));
        }
        LOOP_ALLOCATOR_CALLS.store(allocator_calls_so_far(), Ordering::Relaxed);
        if self.began.is_never() {
            self.began = tick.woke;
        }
        let since_s = tick.woke.since(self.began).as_secs_f64();
        if self.at_s.is_some_and(|at_s| since_s >= at_s) {
            thread::sleep(Duration::from_secs(3_600));
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "injection"
    }
}

/// An injected pause of the main thread, which reads no messages meanwhile.
#[derive(Debug)]
pub(super) struct Pause {
    at_s: Option<f64>,
    begun: Instant,
}

impl Pause {
    pub(super) fn from_environment() -> Self {
        Self {
            at_s: number("FCCD_PAUSE_AT_S"),
            begun: Instant::now(),
        }
    }

    /// Waits when it is due.
    pub(super) fn look(&mut self) {
        if self
            .at_s
            .take_if(|at_s| self.begun.elapsed().as_secs_f64() >= *at_s)
            .is_some()
        {
            thread::sleep(Duration::from_secs_f64(
                number("FCCD_PAUSE_S").unwrap_or(3_600.0),
            ));
        }
    }
}

/// Fails instead of releasing the controls, if that is to happen.
pub(super) fn fail_release() {
    let how = std::env::var("FCCD_RELEASE_FAILS").unwrap_or_default();
    assert!(how != "panics", "injected panic of the release");
    if how == "blocks" {
        thread::sleep(Duration::from_secs(3_600));
    }
}

fn number(name: &str) -> Option<f64> {
    std::env::var(name).ok()?.parse().ok()
}

/// What replaces control, if a fault of it is to happen. Nothing otherwise: the controls
/// of a replaced control are released at once, and those of the autopilot level first.
pub(super) fn faulty_control() -> Option<Box<dyn ControlOverride>> {
    let faulty = Faulty::from_environment();
    faulty.is_armed().then(|| Box::new(faulty) as _)
}

impl Faulty {
    /// Reads the faults from the environment.
    fn from_environment() -> Self {
        Self {
            panic_at_s: number("FCCD_PANIC_AT_S"),
            nan_at_s: number("FCCD_NAN_AT_S"),
            hang_at_s: number("FCCD_HANG_AT_S"),
            slow: Slow::from_environment(),
            engaged_at: Time::NEVER,
        }
    }

    fn is_armed(&self) -> bool {
        [
            self.panic_at_s,
            self.nan_at_s,
            self.hang_at_s,
            self.slow.at_s,
        ]
        .iter()
        .any(Option::is_some)
    }

    fn is_due(&self, at_s: Option<f64>, tick: &Tick) -> bool {
        at_s.is_some_and(|at_s| tick.woke.since(self.engaged_at).as_secs_f64() >= at_s)
    }
}

impl ControlOverride for Faulty {
    fn engage(&mut self, tick: &Tick) {
        self.engaged_at = tick.woke;
    }

    fn control(
        &mut self,
        _: &Autopilot,
        tick: &Tick,
        _: &Measurements,
        mut surfaces: Surfaces,
    ) -> Surfaces {
        assert!(!self.is_due(self.panic_at_s, tick), "injected panic");
        while self.is_due(self.hang_at_s, tick) {
            std::hint::spin_loop();
        }
        if self.is_due(self.slow.at_s, tick) {
            self.slow.take_longer();
        }
        if self.is_due(self.nan_at_s, tick) {
            surfaces.elevator = f64::NAN;
        }
        surfaces
    }
}
