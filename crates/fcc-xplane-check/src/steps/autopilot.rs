//! Step 16: X-Plane's own autopilot.

use std::time::{Duration, Instant};

use super::paths;
use crate::bench::{Bench, Done, ENGAGES_WITHIN, failed};
use crate::configuration::Guidance;
use crate::step::Step;
use crate::watched::Watched;

const ON_WITHIN: Duration = Duration::from_secs(3);

pub(super) const AUTOPILOT: Step = Step {
    number: 16,
    title: "X-Plane's own autopilot on: engaging is refused",
    action: "The check switches X-Plane's autopilot on, and then fccd's engage switch.",
    passes: "fccd does not engage and says why.",
    source: "control totals are yoke + servo + artificial stability: both would move the surfaces",
    advice: "This aircraft's autopilot is not X-Plane's own, so fccd does not see it: switch it \
             off yourself before engaging.",
    run: autopilot,
    restore: |bench| {
        bench.set_switch(false);
        bench.link.command(paths::SERVOS_OFF);
    },
};

fn autopilot(bench: &mut Bench<'_>) -> Done {
    bench.disengage()?;
    bench.ready(Guidance::Hold)?;
    bench.link.command(paths::SERVOS_ON);
    let is_on = |b: &Bench<'_>| b.number(Watched::ServosOn) >= 0.5;
    if !bench.until("X-Plane's autopilot is on", ON_WITHIN, is_on)? {
        if bench.is_unattended {
            return failed("X-Plane's autopilot did not switch on");
        }
        bench.have_done(
            "servos",
            "Switch the aircraft's autopilot on.",
            "X-Plane's autopilot is on",
            is_on,
        )?;
    }
    bench.wait("fccd sees it", Duration::from_millis(700))?;
    let since = Instant::now();
    bench.set_switch(true);
    bench.wait("fccd refuses", ENGAGES_WITHIN)?;
    bench.measure_overridden("replies with an override set", since);
    if !bench.has_said(since, &["not engaged"]) {
        return failed("fccd did not say that it refuses to engage");
    }
    bench.set_switch(false);
    bench.link.command(paths::SERVOS_OFF);
    bench.expect("X-Plane's autopilot is off", ON_WITHIN, |b| !is_on(b))
}
