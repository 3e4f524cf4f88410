//! Step 11: the pattern.

use std::time::Duration;

use serde_json::Value;

use crate::bench::{Bench, Done, failed};
use crate::configuration::Guidance;
use crate::figure::Limit;
use crate::step::Step;

/// A leg shorter than this has no settled part to be measured.
const SETTLED_LEG_S: f64 = 20.0;

pub(super) const PATTERN: Step = Step {
    number: 11,
    title: "the timed pattern within its limits",
    action: "fccd holds, then turns right and climbs, turns right and descends, with the gains of \
             the configuration.",
    passes: "On every leg the heading settles within 2° and the altitude within 10 ft; overshoot, \
             errors and side force are within their limits.",
    source: "2° and 10 ft: the bands of fccd's score; the others at least twice the limits of the \
             Cessnas in the flight suite (hil/fcc_hil/suite/limit_table.py)",
    advice: "The gains do not suit this aircraft: docs/x-plane.md says how to find others. Fly in \
             calm air and trimmed.",
    run: pattern,
    restore: |bench| {
        bench.set_switch(false);
        bench.daemon.stop();
    },
};

fn pattern(bench: &mut Bench<'_>) -> Done {
    bench.engage(Guidance::Pattern)?;
    let waits = bench.waits;
    // A moment longer, so that the last leg is complete.
    let flies_s = waits.hold_s + f64::from(waits.legs) * waits.leg_s + 1.0;
    bench.wait("the pattern", Duration::from_secs_f64(flies_s))?;
    let is_held = bench.is_held();
    let Some(ended) = bench.daemon.stop() else {
        return failed("fccd did not run until the end of the pattern");
    };
    if !is_held {
        return failed("fccd was not engaged at the end of the pattern");
    }
    let Some(worst) = ended
        .result
        .as_ref()
        .and_then(|result| result.pointer("/flight/worst"))
        .filter(|worst| worst.is_object())
    else {
        return failed("fccd reported no complete leg");
    };
    let number = |key: &str| worst.get(key).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let leg = Limit::AtMost(waits.leg_s);
    for (name, key, unit, limit) in [
        ("heading settles within 2°", "heading_settle_s", "s", leg),
        (
            "heading overshoot",
            "heading_overshoot_deg",
            "°",
            Limit::AtMost(2.0),
        ),
        (
            "altitude settles within 10 ft",
            "altitude_settle_s",
            "s",
            leg,
        ),
        (
            "altitude overshoot",
            "altitude_overshoot_ft",
            "ft",
            Limit::AtMost(10.0),
        ),
        (
            "height lost in a turn",
            "turn_loss_ft",
            "ft",
            Limit::AtMost(10.0),
        ),
        (
            "airspeed error",
            "airspeed_error_kt",
            "kt",
            Limit::AtMost(16.0),
        ),
        (
            "side force",
            "lateral_acceleration_g",
            "g",
            Limit::AtMost(0.1),
        ),
    ] {
        bench.measure(name, number(key), unit, limit);
    }
    if waits.leg_s >= SETTLED_LEG_S {
        for (name, key, unit, most) in [
            ("heading error, settled", "heading_rms_deg", "°", 1.0),
            ("altitude error, settled", "altitude_rms_ft", "ft", 5.0),
        ] {
            bench.measure(name, number(key), unit, Limit::AtMost(most));
        }
    }
    Ok(())
}
