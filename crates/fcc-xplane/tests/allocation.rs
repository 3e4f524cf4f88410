//! Nothing in a tick allocates: 10,000 of them under a counting allocator.
#![expect(unsafe_code, reason = "a global allocator cannot be had without")]

mod support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor};
use fcc_xplane::{Output, XPlane};
use support::{FakeXPlane, Ticks};

thread_local! {
    /// Allocations of this thread while it counts; the test's own end of the
    /// wire allocates as it likes in between.
    static COUNTED: Cell<Option<u64>> = const { Cell::new(None) };
}

struct Counting;

fn note() {
    COUNTED.with(|counted| {
        if let Some(count) = counted.get() {
            counted.set(Some(count + 1));
        }
    });
}

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        note();
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often `act` allocates or frees.
fn allocations(act: impl FnOnce()) -> u64 {
    COUNTED.set(Some(0));
    act();
    COUNTED.replace(None).unwrap_or_default()
}

#[test]
fn the_counter_counts() {
    // One to allocate, one to free.
    assert_eq!(allocations(|| drop(std::hint::black_box(Box::new(1)))), 2);
}

#[test]
fn ten_thousand_ticks_allocate_nothing() {
    for output in [Output::Dref, Output::Data] {
        let mut simulator = FakeXPlane::new();
        let mut config = simulator.config();
        config.output = output;
        config.engines = 4;
        let (mut sensor, mut actuator) = XPlane::open(&config).unwrap();
        let mut ticks = Ticks::new();
        let mut measurements = Measurements::default();
        let mut counted = 0;
        let mut faults = 0;
        for number in 0..10_000_u32 {
            let surfaces = Surfaces {
                elevator: (f64::from(number) * 0.01).sin(),
                ..Surfaces::default()
            };
            // Flying, released, silent for a while, garbled: all that a tick
            // may meet.
            let silent = (3_000..3_400).contains(&number);
            if !silent {
                simulator.live(0.025);
                if number % 100 == 0 {
                    simulator.send(b"RREF,cut");
                    simulator.send(b"what is this");
                }
            }
            let tick = ticks.next();
            counted += allocations(|| {
                sensor.warm_up(&tick);
                actuator.warm_up(&tick, &surfaces);
                faults += u32::from(sensor.sample(&tick, &mut measurements).is_err());
                if number % 1_000 < 900 {
                    faults += u32::from(actuator.apply(&tick, &surfaces).is_err());
                } else {
                    faults += u32::from(actuator.release().is_err());
                }
            });
        }
        assert_eq!(counted, 0, "{output:?}");
        assert!(faults > 0, "the ways that fail are among those counted");
        assert!(!measurements.position.is_never());
    }
}
