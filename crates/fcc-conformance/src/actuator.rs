//! Requirements of [`Actuator`]. Each is one function, which panics if it is
//! not met.

use core::fmt::Debug;
use std::thread;

use fcc_core::framework::{Actuator, ActuatorFault, Tick};

use crate::{Ticks, allocator_calls, waiting, waits};

/// An actuator under test: as a loop gets it, together with its plant.
pub trait ActuatorBench: Sized + Send {
    /// The loop's outputs.
    type Outputs: Copy + Debug;

    /// An actuator without control, and its connected plant.
    fn new() -> Self;

    /// The actuator.
    fn actuator(&mut self) -> &mut dyn Actuator<Self::Outputs>;

    /// Valid outputs: different for each number, and different from those of a
    /// plant at rest.
    fn outputs(number: u32) -> Self::Outputs;

    /// Runs the plant until this tick; samples a sensor that belongs to the
    /// actuator. Not counted: it may allocate and wait.
    fn live(&mut self, _tick: &Tick) {}

    /// Whether the actuator has control of the plant, by all messages sent.
    fn is_held(&mut self) -> bool;

    /// Whether the plant follows these outputs.
    fn follows(&mut self, outputs: &Self::Outputs) -> bool;

    /// Number of messages that the plant received; 0 if there are no messages.
    fn messages(&mut self) -> u64 {
        0
    }
}

/// A plant that can be unplugged, switched off or disconnected, and keeps its
/// last outputs.
pub trait VanishingPlant: ActuatorBench {
    /// Ticks of driving an absent plant that are not yet a fault.
    const PATIENCE: usize;

    /// Ticks until a plant that returned follows the outputs.
    const BACK_AFTER: usize;

    /// From now on nothing reaches the plant.
    fn vanish(&mut self);

    /// The plant is connected again, with its last outputs.
    fn come_back(&mut self);
}

/// A bench and its clock.
pub(crate) struct Run<B: ActuatorBench> {
    pub(crate) bench: B,
    ticks: Ticks,
    number: u32,
}

impl<B: ActuatorBench> Run<B> {
    /// A run whose plant has settled.
    pub(crate) fn new() -> Self {
        let mut run = Self {
            bench: B::new(),
            ticks: Ticks::default(),
            number: 0,
        };
        run.live(20);
        run
    }

    /// A run whose actuator has control.
    pub(crate) fn holding() -> Self {
        let mut run = Self::new();
        for _ in 0..20 {
            run.assert_applies();
        }
        assert!(run.bench.is_held());
        run
    }

    pub(crate) fn live(&mut self, ticks: usize) {
        for _ in 0..ticks {
            let tick = self.ticks.next_tick();
            self.bench.live(&tick);
        }
    }

    /// A tick with other outputs than before.
    pub(crate) fn apply(&mut self) -> (Result<(), ActuatorFault>, B::Outputs) {
        let tick = self.ticks.next_tick();
        self.bench.live(&tick);
        self.number += 1;
        let outputs = B::outputs(self.number);
        // Without effect: every requirement is met with and without a warm-up.
        let others = B::outputs(self.number + 1);
        self.bench.actuator().warm_up(&tick, &others);
        (self.bench.actuator().apply(&tick, &outputs), outputs)
    }

    /// With other outputs than applied, and without a tick between.
    fn warm_up(&mut self, times: u32) {
        let before = self.bench.messages();
        let tick = self.ticks.next_tick();
        for number in 1..=times {
            let outputs = B::outputs(self.number + number);
            self.bench.actuator().warm_up(&tick, &outputs);
        }
        assert_eq!(self.bench.messages(), before, "a warm-up sends");
    }

    pub(crate) fn assert_applies(&mut self) {
        let (applied, outputs) = self.apply();
        assert_eq!(applied, Ok(()));
        assert!(self.bench.follows(&outputs), "does not follow {outputs:?}");
    }

    pub(crate) fn release(&mut self) -> Result<(), ActuatorFault> {
        self.bench.actuator().release()
    }

    /// Now, and after some ticks.
    fn assert_released(&mut self) {
        assert!(!self.bench.is_held(), "is still held");
        self.live(40);
        assert!(!self.bench.is_held(), "is held again");
    }

    /// The sum of `count` over a release, several applies and two releases,
    /// twice.
    fn total(&mut self, count: Count<B>) -> u64 {
        let mut total = 0;
        for number in 0..120 {
            let tick = self.ticks.next_tick();
            self.bench.live(&tick);
            let outputs = B::outputs(number);
            total += count(&mut self.bench, &mut |actuator| {
                actuator.warm_up(&tick, &outputs);
                let _ = if matches!(number % 40, 0 | 38 | 39) {
                    actuator.release()
                } else {
                    actuator.apply(&tick, &outputs)
                };
            });
        }
        total
    }
}

/// A counted call of the actuator.
type Call<'a, B> = &'a mut dyn FnMut(&mut dyn Actuator<<B as ActuatorBench>::Outputs>);
type Count<B> = fn(&mut B, Call<'_, B>) -> u64;

fn waited<B: ActuatorBench>(bench: &mut B, call: Call<'_, B>) -> u64 {
    let actuator = bench.actuator();
    waits(|| call(actuator)).1
}

fn allocated<B: ActuatorBench>(bench: &mut B, call: Call<'_, B>) -> u64 {
    let actuator = bench.actuator();
    allocator_calls(|| call(actuator)).1
}

/// Control is free until the first apply, which takes it; the plant follows
/// each apply.
pub fn the_first_apply_takes_control_and_each_is_followed<B: ActuatorBench>() {
    let mut run = Run::<B>::new();
    assert!(!run.bench.is_held(), "held before the first apply");
    for _ in 0..100 {
        run.assert_applies();
        assert!(run.bench.is_held());
    }
}

/// A warm-up takes no control, and sends nothing to the plant.
pub fn a_warm_up_has_no_effect<B: ActuatorBench>() {
    let mut run = Run::<B>::new();
    run.warm_up(100);
    assert!(!run.bench.is_held(), "a warm-up takes control");

    let mut run = Run::<B>::holding();
    let (applied, outputs) = run.apply();
    assert_eq!(applied, Ok(()));
    run.warm_up(100);
    assert!(run.bench.follows(&outputs), "a warm-up moves the plant");
}

/// A release gives up control, and it stays released.
pub fn release_gives_control_back<B: ActuatorBench>() {
    let mut run = Run::<B>::holding();
    assert_eq!(run.release(), Ok(()));
    run.assert_released();
}

/// The second of two releases succeeds and sends nothing.
pub fn a_second_release_does_nothing<B: ActuatorBench>() {
    let mut run = Run::<B>::holding();
    assert_eq!(run.release(), Ok(()));
    for _ in 0..2 {
        let before = run.bench.messages();
        assert_eq!(run.release(), Ok(()));
        assert_eq!(run.bench.messages(), before);
        run.assert_released();
    }
}

/// A release without control succeeds and sends nothing.
pub fn a_release_before_any_apply_does_nothing<B: ActuatorBench>() {
    let mut run = Run::<B>::new();
    let before = run.bench.messages();
    assert_eq!(run.release(), Ok(()));
    assert_eq!(run.bench.messages(), before);
    run.assert_released();
}

/// The next apply after a release takes control again, also directly after it,
/// while the plant has not yet confirmed the release.
pub fn an_apply_after_a_release_takes_control_again<B: ActuatorBench>() {
    let mut run = Run::<B>::holding();
    for pause in [0, 1, 40] {
        assert_eq!(run.release(), Ok(()));
        run.live(pause);
        for _ in 0..40 {
            run.assert_applies();
            assert!(run.bench.is_held());
        }
    }
    assert_eq!(run.release(), Ok(()));
    run.assert_released();
}

/// No apply and no release waits.
pub fn applying_and_releasing_never_wait<B: ActuatorBench>() {
    waiting::assert_never_waits(|| Run::<B>::new().total(waited));
}

/// No apply and no release calls the allocator.
pub fn applying_and_releasing_allocate_nothing<B: ActuatorBench>() {
    assert_eq!(Run::<B>::new().total(allocated), 0);
}

/// An actuator created in one thread and driven in another, like the loop's.
pub fn an_actuator_runs_in_a_thread_it_was_not_made_in<B: ActuatorBench>() {
    let mut run = Run::<B>::new();
    let there = thread::scope(|scope| {
        let driven = scope.spawn(|| {
            run.assert_applies();
            assert_eq!(run.release(), Ok(()));
        });
        driven.join()
    });
    assert!(there.is_ok());
    run.assert_released();
}

/// An actuator's name is constant and has one line.
pub fn its_name_stays<B: ActuatorBench>() {
    let mut run = Run::<B>::new();
    let name = run.bench.actuator().name().to_owned();
    assert!(!name.trim().is_empty() && !name.contains('\n'), "{name:?}");
    run.assert_applies();
    assert_eq!(run.bench.actuator().name(), name);
}

/// Driving an absent plant is a fault after [`VanishingPlant::PATIENCE`] ticks;
/// when it returns, it follows the outputs again, however often.
pub fn a_plant_that_vanished_is_a_fault_until_it_is_back<B: VanishingPlant>() {
    let mut run = Run::<B>::holding();
    for _ in 0..3 {
        run.bench.vanish();
        for _ in 0..B::PATIENCE {
            let _ = run.apply().0;
        }
        for _ in 0..20 {
            assert!(run.apply().0.is_err(), "an absent plant is no fault");
        }
        run.bench.come_back();
        for _ in 0..B::BACK_AFTER {
            let _ = run.apply().0;
        }
        for _ in 0..20 {
            run.assert_applies();
        }
        assert!(run.bench.is_held());
    }
}

/// A release that did not reach the plant is an error, and succeeds when called
/// again, or is repeated by the adapter itself: in either case control is
/// released after the plant's return.
pub fn a_release_that_a_vanished_plant_missed_is_made_up_for<B: VanishingPlant>() {
    for releases_while_away in [0, 1, 2] {
        let mut run = Run::<B>::holding();
        run.bench.vanish();
        let mut owed = true;
        for _ in 0..releases_while_away {
            owed = run.release().is_err();
            run.live(10);
        }
        run.bench.come_back();
        if owed {
            assert_eq!(run.release(), Ok(()));
        }
        run.live(B::BACK_AFTER);
        run.assert_released();
        // Nothing is left that would prevent taking control.
        for _ in 0..20 {
            run.assert_applies();
        }
    }
}

/// The same for a plant that is disconnected and returns.
pub fn driving_what_vanished_never_waits_nor_allocates<B: VanishingPlant>() {
    let scenario = |count: Count<B>| {
        let mut run = Run::<B>::holding();
        run.bench.vanish();
        let away = run.total(count);
        run.bench.come_back();
        away + run.total(count)
    };
    assert_eq!(scenario(allocated), 0);
    waiting::assert_never_waits(|| scenario(waited));
}
