//! Steps 8 to 10: engaging.

use std::time::{Duration, Instant};

use super::paths;
use crate::bench::{Bench, Done, failed};
use crate::configuration::Guidance;
use crate::figure::Limit;
use crate::link::{Sample, flown};
use crate::step::Step;
use crate::watched::Watched;

/// How long each light is on: a frame of X-Plane at 20 frames a second and a
/// tick of the daemon.
const LIGHT_ON: Duration = Duration::from_millis(75);
/// How long it may take from a light until an override is read back.
const VISIBLE_WITHIN: Duration = Duration::from_millis(300);
/// The step in bank that a return may cause (a limit of this project).
pub(super) const BANK_DEG: f64 = 5.0;

pub(super) const LIGHTS: Step = Step {
    number: 8,
    title: "every light switched: only the chosen switch engages",
    action: "The check switches each generic light and the cockpit's lights on and off (afterwards \
             they are off), then the chosen engage switch.",
    passes: "No light but the chosen one sets an override.",
    source: "an aircraft may use a generic light for one of its own",
    advice: "This aircraft connects the named light with the engage switch: choose another \
             x-plane.engage_switch.",
    run: lights,
    restore: |bench| bench.set_switch(false),
};

fn lights(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    bench.ready(Guidance::Hold)?;
    let chosen = bench.link.path(Watched::EngageSwitch).to_owned();
    let generic = (0..=bench.waits.lights).map(|n| format!("{}[{n}]", paths::GENERIC_LIGHTS));
    let cockpit = paths::LIGHTS.iter().map(|path| (*path).to_owned());
    let others: Vec<String> = generic
        .chain(cockpit)
        .filter(|path| *path != chosen)
        .collect();
    let mut switched = Vec::new();
    let began = Instant::now();
    for path in &others {
        switched.push((Instant::now(), path));
        bench.link.write(path, 1.0);
        bench.wait(path, LIGHT_ON)?;
        bench.link.write(path, 0.0);
    }
    bench.wait("an override", VISIBLE_WITHIN)?;
    bench.measure("lights switched", others.len() as f64, "", Limit::Noted);
    let seen = bench
        .link
        .since(began)
        .find(|sample| sample.is_overridden());
    if let Some(first) = seen.map(|sample| sample.at) {
        let shortly_before = switched
            .iter()
            .filter(|(at, _)| *at < first && first - *at < VISIBLE_WITHIN)
            .map(|(_, path)| path.as_str());
        let names: Vec<&str> = shortly_before.collect();
        return failed(format!(
            "an override was set by one of: {}",
            names.join(", ")
        ));
    }
    let since = Instant::now();
    bench.engage(Guidance::Hold)?;
    let took = since.elapsed().as_secs_f64();
    bench.measure(
        "from preparing to engage until engaged",
        took,
        "s",
        Limit::Noted,
    );
    Ok(())
}

pub(super) const BUMP: Step = Step {
    number: 9,
    title: "engaging: overrides set, no bump",
    action: "Fly level; the check engages and watches.",
    passes: "Both overrides stay on; controls, bank, pitch and load do not jump.",
    source: "a step of at most 5° of bank; the load of a bank of 30° is 1.15 g",
    advice: "Another plugin or the aircraft's own fly-by-wire writes the same controls: end it, \
             or choose another aircraft.",
    run: bump,
    restore: |_| {},
};

fn bump(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    bench.ready(Guidance::Hold)?;
    bench.wait("level flight", Duration::from_millis(300))?;
    let Some(before) = bench.link.latest().copied() else {
        return failed("nothing arrives from X-Plane");
    };
    let since = Instant::now();
    bench.engage(Guidance::Hold)?;
    bench.wait("engaged", bench.waits.watch)?;
    let held: Vec<Sample> = bench
        .link
        .since(since)
        .skip_while(|sample| !sample.is_held())
        .copied()
        .collect();
    let Some(first) = held.first() else {
        return failed("the overrides were not set");
    };
    let dropped = held.iter().filter(|sample| !sample.is_held()).count();
    bench.measure(
        "replies without both overrides",
        dropped as f64,
        "",
        Limit::AtMost(0.0),
    );
    // Only surfaces in the first moment: then they fly.
    let soon = held
        .iter()
        .take_while(|sample| sample.at - first.at < Duration::from_millis(100));
    for (name, yoke) in [
        ("elevator", Watched::YokePitch),
        ("aileron", Watched::YokeRoll),
        ("rudder", Watched::YokeHeading),
    ] {
        let step = soon
            .clone()
            .map(|sample| (sample.number(yoke) - before.number(yoke)).abs())
            .fold(0.0, f64::max);
        bench.measure(
            &format!("step of the {name}"),
            step,
            "",
            Limit::AtMost(0.15),
        );
    }
    let change = |what| {
        held.iter()
            .map(|sample| (sample.number(what) - first.number(what)).abs())
            .fold(0.0, f64::max)
    };
    let (bank, pitch) = (change(Watched::Roll), change(Watched::Pitch));
    let load = change(Watched::LoadNormal);
    bench.measure("change of bank", bank, "°", Limit::AtMost(BANK_DEG));
    bench.measure("change of pitch", pitch, "°", Limit::AtMost(5.0));
    bench.measure("change of load", load, "g", Limit::AtMost(0.3));
    Ok(())
}

pub(super) const JOYSTICK: Step = Step {
    number: 10,
    title: "the joystick fully over: no effect",
    action: "While fccd flies, hold the joystick fully to the right and back; centre it when asked.",
    passes: "The aircraft keeps its bank, and the controls stay fccd's.",
    source: "override_joystick disconnects the joystick (X-Plane's DataRefs.txt)",
    advice: "A plugin reads the joystick and writes the controls itself: end it.",
    run: joystick,
    restore: |bench| {
        let _ = bench.have_confirmed("joystick-centred", "Centre the joystick, then press Enter.");
    },
};

fn joystick(bench: &mut Bench<'_>) -> Done {
    bench.engage(Guidance::Hold)?;
    let bank = bench.number(Watched::Roll);
    bench.have_confirmed(
        "joystick-over",
        "Hold the joystick fully to the right and back, and press Enter.",
    )?;
    let since = Instant::now();
    bench.wait("the joystick is over", bench.waits.watch)?;
    let changed = extreme(bench, since, |s| (s.number(Watched::Roll) - bank).abs());
    let roll = extreme(bench, since, |s| s.number(Watched::YokeRoll).abs());
    bench.measure("change of bank", changed, "°", Limit::AtMost(BANK_DEG));
    bench.measure("largest aileron", roll, "", Limit::AtMost(0.6));
    let dropped = bench
        .link
        .since(since)
        .filter(|sample| !sample.is_held())
        .count();
    bench.measure(
        "replies without both overrides",
        dropped as f64,
        "",
        Limit::AtMost(0.0),
    );
    Ok(())
}

/// The largest of a number over the samples of the flight since a time.
pub(super) fn extreme(bench: &Bench<'_>, since: Instant, of: impl Fn(&Sample) -> f64) -> f64 {
    flown(bench.link.since(since)).map(of).fold(0.0, f64::max)
}
