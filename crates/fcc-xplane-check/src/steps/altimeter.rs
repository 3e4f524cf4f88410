//! Step 15: the pilot's altimeter.

use std::time::{Duration, Instant};

use super::engaging::extreme;
use super::paths;
use super::stops::Flight;
use crate::bench::{Bench, Done, failed};
use crate::figure::Limit;
use crate::step::Step;
use crate::watched::Watched;

/// About 300 ft: 1 inHg is about 1,000 ft near sea level.
const TURN_INHG: f64 = 0.30;
/// A click is 0.01 inHg.
const CLICKS: u32 = 10;
const CLICK_EVERY: Duration = Duration::from_millis(100);
/// A limit of this project.
const MOST_FT: f64 = 5.0;
const FOOT_M: f64 = 0.3048;

pub(super) const ALTIMETER: Step = Step {
    number: 15,
    title: "the altimeter's setting + 0.30 inHg, then by clicks: the altitude stays",
    action: "The check turns the pilot's altimeter by 0.30 inHg at once and back, then by clicks.",
    passes: "The aircraft's height changes by at most 5 ft.",
    source: "a limit of this project; 0.30 inHg are about 300 ft on the altimeter (ICAO Doc 7488)",
    advice: "fccd flies by this aircraft's indicated altitude, and cannot correct it: send this \
             report, and do not turn the altimeter while fccd flies.",
    run: altimeter,
    restore: |_| {},
};

fn altimeter(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    bench.until("steady height", Duration::from_secs(10), |b| {
        b.number(Watched::ClimbRate).abs() < 60.0
    })?;
    let setting = bench.number(Watched::AltimeterSetting);
    if !setting.is_finite() {
        return failed("X-Plane does not send the altimeter's setting");
    }
    let path = bench.link.path(Watched::AltimeterSetting).to_owned();
    let before_m = bench.number(Watched::Elevation);
    let since = Instant::now();
    bench.link.write(&path, setting + TURN_INHG);
    bench.expect("the altimeter is turned", Duration::from_secs(3), |b| {
        (b.number(Watched::AltimeterSetting) - setting).abs() > 0.9 * TURN_INHG
    })?;
    bench.wait("at the new setting", bench.waits.altimeter)?;
    bench.link.write(&path, setting);
    for command in [paths::ALTIMETER_UP, paths::ALTIMETER_DOWN] {
        for _ in 0..CLICKS {
            bench.link.command(command);
            bench.wait("click by click", CLICK_EVERY)?;
        }
    }
    bench.wait("at the old setting", bench.waits.watch)?;
    let change_ft = extreme(bench, since, |sample| {
        (sample.number(Watched::Elevation) - before_m).abs() / FOOT_M
    });
    bench.measure("change of height", change_ft, "ft", Limit::AtMost(MOST_FT));
    bench.link.write(&path, setting);
    flight.is_held(bench);
    flight.without_failsafe(bench)
}
