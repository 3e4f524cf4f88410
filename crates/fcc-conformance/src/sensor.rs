//! Requirements of [`Sensor`]. Each is one function, which panics if it is not
//! met.

use core::fmt::Debug;
use std::thread;

use fcc_core::framework::{Sensor, SensorFault, Tick, Time};

use crate::{Ticks, allocator_calls, waiting, waits};

/// A sensor under test: as a loop gets it, together with its source.
pub trait SensorBench: Sized + Send {
    /// The loop's measurements.
    type Measurements: Copy + Default + PartialEq + Debug;

    /// Ticks with data provided until every reading has arrived: more than one
    /// if the source must first be asked.
    const CONNECTED_AFTER: usize = 1;

    /// Whether sampling alone gives new values, as for a plant that is computed
    /// by its sensor.
    const MEASURES_UNASKED: bool = false;

    /// A sensor that has not been sampled yet, and its connected source.
    fn new() -> Self;

    /// The sensor.
    fn sensor(&mut self) -> &mut dyn Sensor<Self::Measurements>;

    /// The source provides its next values for the next sample. Not counted: it
    /// may allocate and wait.
    fn provide(&mut self);

    /// The times of the readings that this sensor provides.
    fn taken(measurements: &Self::Measurements) -> Vec<Time>;
}

/// A source that can be unplugged, switched off or killed.
pub trait VanishingSource: SensorBench {
    /// Ticks of silence that are not yet a fault.
    const PATIENCE: usize = 0;

    /// Ticks until every reading arrives again from a source that returned.
    const BACK_AFTER: usize = Self::CONNECTED_AFTER;

    /// From now on the source provides nothing.
    fn vanish(&mut self);

    /// The source is connected again, possibly without its former state.
    fn come_back(&mut self);
}

/// A bench, its clock and the loop's measurements.
struct Run<B: SensorBench> {
    bench: B,
    ticks: Ticks,
    measured: B::Measurements,
}

impl<B: SensorBench> Run<B> {
    fn new() -> Self {
        Self {
            bench: B::new(),
            ticks: Ticks::default(),
            measured: B::Measurements::default(),
        }
    }

    /// A run whose readings have all arrived.
    fn connected() -> Self {
        let mut run = Self::new();
        run.connect(B::CONNECTED_AFTER);
        run
    }

    fn connect(&mut self, ticks: usize) {
        for _ in 0..ticks {
            self.bench.provide();
            // A fault until the source has been received.
            let _ = self.sample();
        }
        self.bench.provide();
        assert_eq!(self.sample(), Ok(()));
    }

    fn sample(&mut self) -> Result<(), SensorFault> {
        let tick = self.ticks.next_tick();
        self.sample_at(&tick)
    }

    fn sample_at(&mut self, tick: &Tick) -> Result<(), SensorFault> {
        // Without effect: every requirement is met with and without a warm-up.
        self.bench.sensor().warm_up(tick);
        self.bench.sensor().sample(tick, &mut self.measured)
    }

    fn taken(&self) -> Vec<Time> {
        B::taken(&self.measured)
    }

    /// The sum of `count` over samples of every kind: before the first value,
    /// with new ones, without, late, and after missed ticks.
    fn total(&mut self, mut count: impl FnMut(&mut Self, Tick) -> u64) -> u64 {
        let mut total = 0;
        for number in 0..200 {
            if (20..120).contains(&number) {
                self.bench.provide();
            }
            let missed = if number % 50 == 49 { 40 } else { 0 };
            let tick = self.ticks.next_after(missed);
            total += count(self, tick);
        }
        total
    }
}

/// How often a sample waits.
fn waited<B: SensorBench>(run: &mut Run<B>, tick: Tick) -> u64 {
    waits(|| run.sample_at(&tick)).1
}

/// How often a sample calls the allocator.
fn allocated<B: SensorBench>(run: &mut Run<B>, tick: Tick) -> u64 {
    allocator_calls(|| run.sample_at(&tick)).1
}

/// Every reading arrives within [`SensorBench::CONNECTED_AFTER`] ticks and
/// continues to; no time is in the future or goes back.
pub fn every_reading_comes_and_none_is_of_the_future<B: SensorBench>() {
    let mut run = Run::<B>::connected();
    let first = run.taken();
    assert!(!first.is_empty(), "a sensor gives at least one reading");
    assert!(first.iter().all(|at| !at.is_never()), "{:?}", run.measured);
    let mut before = first.clone();
    for _ in 0..100 {
        run.bench.provide();
        let tick = run.ticks.next_tick();
        run.sample_at(&tick).unwrap_or_else(fault);
        let taken = run.taken();
        for (at, before) in taken.iter().zip(&before) {
            assert!(*at <= tick.woke, "of the future: {:?}", run.measured);
            assert!(at >= before, "goes back in time: {:?}", run.measured);
        }
        before = taken;
    }
    for (at, first) in before.iter().zip(&first) {
        assert!(at > first, "comes no more: {:?}", run.measured);
    }
}

fn fault(fault: SensorFault) {
    let none: Result<(), SensorFault> = Ok(());
    assert_eq!(Err(fault), none);
}

/// Without new data from the source, values and times do not change, also those
/// of other sensors.
pub fn a_source_with_nothing_new_changes_no_value<B: SensorBench>() {
    if B::MEASURES_UNASKED {
        return;
    }
    let mut run = Run::<B>::connected();
    let before = run.measured;
    for _ in 0..5 {
        let _ = run.sample();
        assert_eq!(run.measured, before);
    }
}

/// The tick after missed ones gets the data that arrived meanwhile, without a
/// fault.
pub fn a_tick_after_missed_ones_is_sampled_like_any<B: SensorBench>() {
    let mut run = Run::<B>::connected();
    let before = run.taken();
    run.bench.provide();
    let tick = run.ticks.next_after(3);
    run.sample_at(&tick).unwrap_or_else(fault);
    for (at, before) in run.taken().iter().zip(&before) {
        assert!(at >= before && *at <= tick.woke, "{:?}", run.measured);
    }
}

/// No sample waits, whether there is data or not.
pub fn sampling_never_waits<B: SensorBench>() {
    waiting::assert_never_waits(|| Run::<B>::new().total(waited));
}

/// No sample calls the allocator.
pub fn sampling_allocates_nothing<B: SensorBench>() {
    assert_eq!(Run::<B>::new().total(allocated), 0);
}

/// A sensor created in one thread and sampled in another, like the loop's.
pub fn a_sensor_runs_in_a_thread_it_was_not_made_in<B: SensorBench>() {
    let mut run = Run::<B>::connected();
    let there = thread::scope(|scope| {
        let sampled = scope.spawn(|| {
            run.bench.provide();
            let tick = run.ticks.next_tick();
            run.bench
                .sensor()
                .sample(&tick, &mut B::Measurements::default())
        });
        sampled.join()
    });
    assert!(matches!(there, Ok(Ok(()))), "{there:?}");
}

/// A sensor's name is constant and has one line.
pub fn its_name_stays<B: SensorBench>() {
    let mut run = Run::<B>::new();
    let name = run.bench.sensor().name().to_owned();
    assert!(!name.trim().is_empty() && !name.contains('\n'), "{name:?}");
    run.connect(B::CONNECTED_AFTER);
    assert_eq!(run.bench.sensor().name(), name);
}

/// There is no reading while the source is absent, and other sensors'
/// measurements are unchanged.
pub fn nothing_is_measured_before_the_source_is_there<B: VanishingSource>() {
    let others = Run::<B>::connected().measured;
    for before in [B::Measurements::default(), others] {
        let mut run = Run::<B>::new();
        run.bench.vanish();
        run.measured = before;
        for _ in 0..100 {
            run.bench.provide();
            let _ = run.sample();
            assert_eq!(run.measured, before);
        }
    }
}

/// A measurement from before the source vanished keeps its value and its time.
pub fn an_old_value_stays_old<B: VanishingSource>() {
    let mut run = Run::<B>::connected();
    run.bench.vanish();
    let before = run.measured;
    for _ in 0..B::PATIENCE + 100 {
        run.bench.provide();
        let _ = run.sample();
        assert_eq!(run.measured, before);
    }
}

/// A source that vanishes is a fault after [`VanishingSource::PATIENCE`] ticks,
/// as long as it is absent; when it returns, so does every reading, however
/// often.
pub fn silence_is_reported_and_ends<B: VanishingSource>() {
    let mut run = Run::<B>::connected();
    for _ in 0..3 {
        let before = run.taken();
        run.bench.vanish();
        for _ in 0..=B::PATIENCE {
            run.bench.provide();
            let _ = run.sample();
        }
        for _ in 0..50 {
            run.bench.provide();
            let result = run.sample();
            let is_fault = matches!(result, Err(SensorFault::Silent | SensorFault::Io { .. }));
            assert!(is_fault, "an absent source must be a fault: {result:?}");
        }
        run.bench.come_back();
        run.connect(B::BACK_AFTER);
        for (at, before) in run.taken().iter().zip(&before) {
            assert!(at > before, "does not come back: {:?}", run.measured);
        }
    }
}

/// The same for a source that is disconnected and returns.
pub fn sampling_what_vanished_never_waits_nor_allocates<B: VanishingSource>() {
    let scenario = |count: fn(&mut Run<B>, Tick) -> u64| {
        let mut run = Run::<B>::connected();
        let mut total = 0;
        for away in [true, false] {
            if away {
                run.bench.vanish();
            } else {
                run.bench.come_back();
            }
            for _ in 0..B::PATIENCE + 50 {
                run.bench.provide();
                let tick = run.ticks.next_tick();
                total += count(&mut run, tick);
            }
        }
        total
    };
    assert_eq!(scenario(allocated), 0);
    waiting::assert_never_waits(|| scenario(waited));
}
