//! Duration of a tick and of each of its stages, on this machine. Each includes
//! reading the clock around each call, about 50 ns.

use std::time::{Duration, Instant};

use bench_tick::{Flight, Stages};
use criterion::{Criterion, criterion_group, criterion_main};

/// Time of `act` alone, called `times` times, with `prepare` before each.
fn timed<T>(of: &mut T, times: u64, prepare: impl Fn(&mut T), act: impl Fn(&mut T)) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..times {
        prepare(of);
        let began = Instant::now();
        act(of);
        total += began.elapsed();
    }
    total
}

fn whole(criterion: &mut Criterion) {
    let mut flight = Flight::engaged();
    criterion.bench_function("tick/whole, X-Plane over loopback", |bencher| {
        bencher.iter_custom(|times| {
            timed(&mut flight, times, Flight::frame, |flight| {
                flight.tick();
            })
        });
    });
}

type Stage = fn(&mut Stages);

fn stages(criterion: &mut Criterion) {
    let mut stages = Stages::engaged();
    // Each with what comes before it in a tick: what navigation has not seen is
    // not controlled.
    let each: [(&str, Stage, Stage); 7] = [
        ("sensors, decoding", Stages::next, Stages::sensors),
        ("navigation", Stages::next, Stages::navigation),
        ("guidance", Stages::next_seen, Stages::guidance),
        ("control", Stages::next_guided, Stages::control),
        (
            "navigation, guidance and control",
            Stages::next,
            Stages::step,
        ),
        ("actuators, encoding", Stages::next, Stages::actuators),
        ("record into the ring", Stages::next, Stages::record),
    ];
    let mut group = criterion.benchmark_group("stage");
    for (name, before, stage) in each {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|times| timed(&mut stages, times, before, stage));
        });
    }
    let mut by_raw_sensors = Stages::engaged_by_raw_sensors();
    group.bench_function("the same from raw sensors", |bencher| {
        bencher.iter_custom(|times| timed(&mut by_raw_sensors, times, Stages::next, Stages::step));
    });
    let mut by_two_sets = Stages::engaged_by_two_sets();
    group.bench_function("the same from two sets of them", |bencher| {
        bencher.iter_custom(|times| timed(&mut by_two_sets, times, Stages::next, Stages::step));
    });
    group.finish();
}

criterion_group!(benches, whole, stages);
criterion_main!(benches);
