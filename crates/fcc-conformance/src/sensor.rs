//! What [`Sensor`] promises. Each promise is one function, and panics where it
//! is broken.

use core::fmt::Debug;
use std::thread;

use fcc_core::framework::{Sensor, SensorFault, Tick, Time};

use crate::{Ticks, allocator_calls, waiting, waits};

/// A sensor on a bench: as a loop gets it, beside the source that it reads.
pub trait SensorBench: Sized + Send {
    /// What the loop measures.
    type Measurements: Copy + Default + PartialEq + Debug;

    /// Ticks with something provided until every reading has come: more than
    /// one where the source must be asked first.
    const CONNECTED_AFTER: usize = 1;

    /// Whether sampling alone makes new values, as of a plant that is computed
    /// by its sensor.
    const MEASURES_UNASKED: bool = false;

    /// A sensor that was not sampled yet, and its source, which is there.
    fn new() -> Self;

    /// The sensor.
    fn sensor(&mut self) -> &mut dyn Sensor<Self::Measurements>;

    /// The source gives its next values, for the next sample to find. Not
    /// counted: it may allocate and wait.
    fn provide(&mut self);

    /// When each reading that this sensor gives was taken.
    fn taken(measurements: &Self::Measurements) -> Vec<Time>;
}

/// A source that can be unplugged, switched off or killed.
pub trait VanishingSource: SensorBench {
    /// Ticks of silence that are no fault yet.
    const PATIENCE: usize = 0;

    /// Ticks until every reading comes again from a source that is back.
    const BACK_AFTER: usize = Self::CONNECTED_AFTER;

    /// From now on the source gives nothing, whatever is provided.
    fn vanish(&mut self);

    /// The source is there again, and may know nothing of before.
    fn come_back(&mut self);
}

/// A bench, its clock and what the loop has measured.
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

    /// One whose readings have all come.
    fn connected() -> Self {
        let mut run = Self::new();
        run.connect(B::CONNECTED_AFTER);
        run
    }

    fn connect(&mut self, ticks: usize) {
        for _ in 0..ticks {
            self.bench.provide();
            // A fault as long as the source has not been heard of.
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
        // Without effect: every promise holds with a warm-up as without.
        self.bench.sensor().warm_up(tick);
        self.bench.sensor().sample(tick, &mut self.measured)
    }

    fn taken(&self) -> Vec<Time> {
        B::taken(&self.measured)
    }

    /// What `count` counts in samples of every kind: before the first value,
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

/// Every reading comes within [`SensorBench::CONNECTED_AFTER`] ticks and goes
/// on coming; no time ever lies ahead or goes back.
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

/// Where the source gives nothing new, values and times stay as they are: what
/// others wrote, too.
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

/// The tick after missed ones brings what came meanwhile, and no fault.
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

/// No sample waits, be there something to read or not.
pub fn sampling_never_waits<B: SensorBench>() {
    waiting::assert_never_waits(|| Run::<B>::new().total(waited));
}

/// No sample calls the allocator.
pub fn sampling_allocates_nothing<B: SensorBench>() {
    assert_eq!(Run::<B>::new().total(allocated), 0);
}

/// A sensor made here and sampled there, as the loop's is.
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

/// A sensor has one name, on one line.
pub fn its_name_stays<B: SensorBench>() {
    let mut run = Run::<B>::new();
    let name = run.bench.sensor().name();
    assert!(!name.trim().is_empty() && !name.contains('\n'), "{name:?}");
    run.connect(B::CONNECTED_AFTER);
    assert_eq!(run.bench.sensor().name(), name);
}

/// Nothing is made up while the source is away, and what others have measured
/// is left as it is.
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

/// What was measured before the source vanished keeps its value and its time.
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
/// and as long as it is away; once it is back, so is every reading. As often
/// as it likes.
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
            let said = run.sample();
            let told = matches!(said, Err(SensorFault::Silent | SensorFault::Io { .. }));
            assert!(told, "a source that is away is said to be: {said:?}");
        }
        run.bench.come_back();
        run.connect(B::BACK_AFTER);
        for (at, before) in run.taken().iter().zip(&before) {
            assert!(at > before, "does not come back: {:?}", run.measured);
        }
    }
}

/// The same for a source that is away and comes back.
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
