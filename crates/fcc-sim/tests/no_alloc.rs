//! Nothing in a tick asks the allocator for anything.
#![expect(unsafe_code, reason = "a counting allocator is an unsafe trait")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick};
use fcc_sim::{Channels, SensorConfig, Severity, SimConfig, Simulation};

thread_local! {
    // Const and without a destructor, so that counting does not allocate; by
    // thread, because the test harness has threads of its own.
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

struct Counting;

// SAFETY: everything is handed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: the caller keeps the contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        CALLS.set(CALLS.get() + 1);
        // SAFETY: the caller keeps the contract.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn ten_thousand_ticks_do_not_allocate() {
    let mut sim = Simulation::new(&SimConfig {
        gusts: Some(Severity::Severe),
        sensors: SensorConfig {
            noise: Channels::TYPICAL_NOISE,
            bias: Channels::TYPICAL_NOISE,
            resolution: Channels::TYPICAL_NOISE,
            delay_ms: 100,
        },
        ..SimConfig::default()
    })
    .unwrap();
    let mut measured = Measurements::default();
    let before = CALLS.get();
    for number in 0..10_000 {
        let dt_s = if number % 100 == 0 { 0.1 } else { 0.025 };
        let tick = Tick {
            number,
            dt_s,
            ..Tick::default()
        };
        sim.sensor.sample(&tick, &mut measured).unwrap();
        let surfaces = Surfaces {
            throttle: 0.8,
            aileron: (-measured.attitude.value.roll_rad).clamp(-1.0, 1.0),
            ..Surfaces::default()
        };
        sim.actuator.apply(&tick, &surfaces).unwrap();
        if number % 1_000 == 999 {
            sim.actuator.release().unwrap();
        }
    }
    assert_eq!(CALLS.get() - before, 0);
    // And the counter counts.
    drop(Box::new(measured));
    assert_eq!(CALLS.get() - before, 2);
}
