//! Step 17: the rate of X-Plane's time, and of its frames.

use std::time::{Duration, Instant};

use super::paths;
use super::stops::Flight;
use crate::bench::{Bench, Done};
use crate::figure::Limit;
use crate::step::Step;
use crate::watched::Watched;

pub(super) const TIME: Step = Step {
    number: 17,
    title: "time twice as fast; 15 frames a second",
    action: "The check sets X-Plane's time to twice its rate and back. Then reduce X-Plane to \
             about 15 frames a second (highest graphics settings), and restore it when asked.",
    passes: "fccd flies on at both.",
    source: "a limit of this project: time up to 2 times as fast is flown; below 19 frames a second X-Plane's \
             time runs slower",
    advice: "Do not change the rate of time while fccd flies; send this report.",
    run: time,
    restore: |bench| {
        bench.link.write(paths::SIM_SPEED, 1.0);
        let _ = bench.have_confirmed(
            "frames-normal",
            "Restore the graphics settings, then press Enter.",
        );
    },
};

/// Frames a second that are few enough: X-Plane slows down below 19.
const FEW_FRAMES: f64 = 1.0 / 17.0;

fn time(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    bench.link.write(paths::SIM_SPEED, 2.0);
    bench.wait("time changes", Duration::from_millis(500))?;
    let rate = rate_of_time(bench)?;
    bench.measure(
        "X-Plane's time, twice as fast",
        rate,
        "s/s",
        Limit::Between(1.5, 2.3),
    );
    bench.link.write(paths::SIM_SPEED, 1.0);
    bench.wait("time changes back", Duration::from_millis(500))?;
    bench.have_done(
        "frames-15",
        "Reduce X-Plane to about 15 frames a second, with the highest graphics settings.",
        "15 frames a second",
        |b| b.number(Watched::FramePeriod) > FEW_FRAMES,
    )?;
    let rate = rate_of_time(bench)?;
    bench.measure(
        "X-Plane's time at few frames a second",
        rate,
        "s/s",
        Limit::Between(0.4, 1.1),
    );
    flight.continues(bench)
}

/// How fast X-Plane's time runs against ours.
fn rate_of_time(bench: &mut Bench<'_>) -> Result<f64, crate::bench::Stop> {
    let since = Instant::now();
    bench.wait("the rate of time", bench.waits.watch)?;
    let mut samples = bench.link.since(since);
    let ends = samples.next().zip(samples.last());
    Ok(ends.map_or(f64::NAN, |(first, last)| {
        (last.number(Watched::FlightTime) - first.number(Watched::FlightTime))
            / (last.at - first.at).as_secs_f64()
    }))
}
