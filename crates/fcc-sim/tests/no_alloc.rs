//! Nothing in a tick allocates.
//!
//! A process of its own: what another test initialises first would not allocate here.

use fcc_conformance::allocator_calls;
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick};
use fcc_sim::{Channels, SensorConfig, Severity, SimConfig, Simulation};

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
    let ((), calls) = allocator_calls(|| {
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
    });
    assert_eq!(calls, 0);
}
