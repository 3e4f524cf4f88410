//! Steps 18 and 19: X-Plane freezes, and reloads the aircraft.

use std::time::{Duration, Instant};

use super::paths;
use super::stops::Flight;
use crate::bench::{Bench, Done, failed};
use crate::figure::Limit;
use crate::step::Step;
use crate::watched::Watched;

/// The shortest freeze that counts: longer than the age at which a single
/// reading is lost (250 ms).
const FREEZE: Duration = Duration::from_millis(300);

const FREEZE_ADVICE: &str = "fccd has taken a freeze of X-Plane for a fault: send this report.";

pub(super) const FREEZE_STEP: Step = Step {
    number: 18,
    title: "a freeze of more than 0.3 s",
    action: "The check has X-Plane load its scenery again, which makes it stand still.",
    passes: "fccd stays engaged, without failsafe, and the bank changes by at most 5°.",
    source: "limits of this project",
    advice: FREEZE_ADVICE,
    run: freeze,
    restore: |_| {},
};

fn freeze(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    let since = Instant::now();
    if !bench.is_unattended {
        bench.link.command(paths::RELOAD_SCENERY);
    }
    bench.have_done(
        "freeze",
        "If X-Plane does not load its scenery by itself, let it: Developer > Reload the Current \
         Scenery.",
        "X-Plane stands still for more than 0.3 s",
        |b| longest_gap(b, since) >= FREEZE.as_secs_f64(),
    )?;
    bench.expect("X-Plane sends again", Duration::from_secs(60), |b| {
        !b.link.is_silent_for(FREEZE)
    })?;
    let gap = longest_gap(bench, since);
    flight.continues(bench)?;
    bench.measure(
        "X-Plane stood still",
        gap,
        "s",
        Limit::AtLeast(FREEZE.as_secs_f64()),
    );
    Ok(())
}

/// The longest time without a datagram since a time, s.
fn longest_gap(bench: &Bench<'_>, since: Instant) -> f64 {
    let times = bench.link.since(since).map(|sample| sample.at);
    let next = times.clone().skip(1);
    times
        .zip(next)
        .map(|(one, next)| (next - one).as_secs_f64())
        .fold(0.0, f64::max)
}

pub(super) const RELOAD: Step = Step {
    number: 19,
    title: "the aircraft is reloaded: the controls are released",
    action: "The check has X-Plane reload the aircraft while fccd flies.",
    passes: "Within 1 s both overrides are off and stay off, and fccd says why.",
    source: "a limit of this project: a reloaded aircraft is another one, or elsewhere",
    advice: "Switch override_joystick and override_throttles off in X-Plane, and send this report.",
    run: reload,
    restore: |bench| {
        bench.set_switch(false);
        let _ = bench.have_done(
            "take-off",
            "Fly again: take off, and climb to at least 2,000 ft above the ground.",
            "the aircraft flies",
            |b| b.number(Watched::OnGround) < 0.5,
        );
    },
};

/// Released within this time.
const RELEASED_WITHIN: Duration = Duration::from_secs(1);

fn reload(bench: &mut Bench<'_>) -> Done {
    Flight::begin(bench)?;
    let since = Instant::now();
    let time = bench.number(Watched::FlightTime);
    bench.link.command(paths::RELOAD);
    let has_reloaded = |b: &Bench<'_>| {
        let now = b.number(Watched::FlightTime);
        longest_gap(b, since) >= FREEZE.as_secs_f64() || now < time || now > time + 60.0
    };
    // A reload takes some seconds, in which nothing arrives; overrides may be
    // off at once.
    if !bench.until("the aircraft is reloaded", Duration::from_secs(10), |b| {
        has_reloaded(b) || !b.is_overridden()
    })? {
        if bench.is_unattended {
            return failed("reloading had no effect: time runs on, the overrides are still on");
        }
        bench.have_done(
            "reload",
            "Reload the aircraft: Developer > Reload the Current Aircraft.",
            "the aircraft is reloaded",
            |b| has_reloaded(b) || !b.is_overridden(),
        )?;
    }
    bench.expect("X-Plane sends again", Duration::from_secs(60), |b| {
        !b.link.is_silent_for(FREEZE)
    })?;
    let back = Instant::now();
    bench.until("the overrides are released", RELEASED_WITHIN * 3, |b| {
        !b.is_overridden()
    })?;
    let took = if bench.is_overridden() {
        f64::NAN
    } else {
        back.elapsed().as_secs_f64()
    };
    let limit = Limit::AtMost(RELEASED_WITHIN.as_secs_f64());
    bench.measure("until both overrides are off", took, "s", limit);
    let off = Instant::now();
    bench.wait("they stay off", bench.waits.watch)?;
    bench.measure_overridden("replies with an override set afterwards", off);
    if bench.has_said(since, &["engaged -> "]) {
        Ok(())
    } else {
        failed("fccd did not say that it released the controls")
    }
}
