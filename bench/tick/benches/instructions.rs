//! Instructions and memory accesses of a tick and of each of its stages: the
//! same on every run. The kernel's are not counted.
#![expect(missing_docs, reason = "gungraun's macros make what has none")]

use bench_tick::{Flight, Stages};
use gungraun::{library_benchmark, library_benchmark_group, main};

fn flight() -> Flight {
    let mut flight = Flight::engaged();
    flight.frame();
    flight
}

fn stages() -> Stages {
    let mut stages = Stages::engaged();
    stages.next();
    stages
}

fn guided() -> Stages {
    let mut stages = Stages::engaged();
    stages.next_guided();
    stages
}

#[library_benchmark]
#[bench::x_plane(flight())]
fn whole(mut flight: Flight) -> Flight {
    flight.tick();
    flight
}

#[library_benchmark]
#[bench::decoding(stages())]
fn sensors(mut stages: Stages) -> Stages {
    stages.sensors();
    stages
}

#[library_benchmark]
#[bench::engaged(stages())]
fn navigation(mut stages: Stages) -> Stages {
    stages.navigation();
    stages
}

#[library_benchmark]
#[bench::engaged(stages())]
fn guidance(mut stages: Stages) -> Stages {
    stages.guidance();
    stages
}

#[library_benchmark]
#[bench::engaged(guided())]
fn control(mut stages: Stages) -> Stages {
    stages.control();
    stages
}

#[library_benchmark]
#[bench::engaged(stages())]
fn step(mut stages: Stages) -> Stages {
    stages.step();
    stages
}

#[library_benchmark]
#[bench::encoding(stages())]
fn actuators(mut stages: Stages) -> Stages {
    stages.actuators();
    stages
}

#[library_benchmark]
#[bench::ring(stages())]
fn record(mut stages: Stages) -> Stages {
    stages.record();
    stages
}

library_benchmark_group!(
    name = tick,
    benchmarks = [
        whole, sensors, navigation, guidance, control, step, actuators, record
    ]
);
main!(library_benchmark_groups = tick);
