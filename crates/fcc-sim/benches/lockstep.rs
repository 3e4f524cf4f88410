//! Speed of the simulation relative to real time, in lockstep at 40 Hz, sensors
//! and actuator included, on one core.
//!
//! An element is a second of flight: criterion's `elem/s` is simulated seconds
//! per second of wall clock.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fcc_core::flight::{Measurements, Surfaces};
use fcc_core::framework::{Actuator, Sensor, Tick};
use fcc_sim::{Channels, SensorConfig, Severity, SimConfig, Simulation};

/// Seconds of flight in one measured pass.
const SECONDS: u32 = 10;

fn lockstep(criterion: &mut Criterion) {
    let calm = SimConfig::default();
    let rough = SimConfig {
        gusts: Some(Severity::Moderate),
        sensors: SensorConfig {
            noise: Channels::TYPICAL_NOISE,
            delay_ms: 25,
            ..SensorConfig::default()
        },
        ..SimConfig::default()
    };
    let mut group = criterion.benchmark_group("lockstep");
    group.throughput(Throughput::Elements(u64::from(SECONDS)));
    for (name, config) in [("calm", calm), ("gusts, noise and delay", rough)] {
        let Ok(mut sim) = Simulation::new(&config) else {
            continue;
        };
        let tick = Tick {
            dt_s: 0.025,
            ..Tick::default()
        };
        let mut measured = Measurements::default();
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                for _ in 0..SECONDS * 40 {
                    let sampled = sim.sensor.sample(&tick, &mut measured);
                    let surfaces = Surfaces {
                        throttle: 0.8,
                        aileron: (-measured.attitude.value.roll_rad).clamp(-1.0, 1.0),
                        ..Surfaces::default()
                    };
                    let applied = sim.actuator.apply(&tick, &surfaces);
                    assert!(sampled.is_ok() && applied.is_ok());
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, lockstep);
criterion_main!(benches);
