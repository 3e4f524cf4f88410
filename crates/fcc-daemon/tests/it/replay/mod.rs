//! A replay reproduces the outputs to the last bit, and finds differences.

mod different;
mod files;
mod flights;
mod identical;
mod incomplete;
mod sources;

use fcc_core::framework::State;
use fcc_fixed_wing::Autopilot;
use fcc_flight::config::Config;
use fcc_flight::replay::replay;
use fcc_replay::{Deviation, run};
use fcc_telemetry::FlightMessage;

use flights::{again, records};

/// The outputs of a tick: surfaces, set points with guidance's progress and the runway of
/// the take-off, the estimate, the step's length, state, engage inhibits, faults, and
/// whether they were sent.
const OUTPUTS: u64 = 70;

/// Asserts that a replay is the same in every bit, and returns the states of
/// the flight.
fn assert_identical(config: &Config, messages: &[FlightMessage]) -> Vec<State> {
    let (run, identity) = again(config, messages);
    let records = records(messages);
    assert_eq!(run.unflown, None);
    assert_eq!(run.ticks, records.len() as u64);
    assert_eq!(identity.outputs, run.ticks * OUTPUTS);
    assert_eq!(identity.differing, 0, "{}", identity.to_text());
    let mut states: Vec<_> = records.iter().map(|record| record.state.state()).collect();
    states.dedup();
    states
}

fn deviation(config: &Config, messages: &[FlightMessage]) -> Deviation {
    let mut deviation = Deviation::of::<Autopilot>();
    run(
        &mut replay(config).unwrap(),
        messages.iter().copied(),
        |recorded, other| {
            deviation.take(recorded, other);
        },
    );
    deviation
}

/// The gain with the last bit of its mantissa flipped.
pub(crate) fn flipped(gain: f64) -> f64 {
    f64::from_bits(gain.to_bits() ^ 1)
}
