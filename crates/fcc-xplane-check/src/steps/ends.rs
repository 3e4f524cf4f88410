//! Step 20: the daemon ends, and is killed.

use std::time::{Duration, Instant};

use nix::sys::signal::Signal;

use crate::bench::{Bench, Done, failed};
use crate::configuration::Guidance;
use crate::figure::Limit;
use crate::step::Step;
use crate::watched::Watched;

/// A limit of this project.
const RELEASED_WITHIN_S: f64 = 1.0;
/// The helper that releases is there this long after control was taken.
const HELPER_WITHIN: Duration = Duration::from_millis(500);
/// A yoke that is centred, or as the joystick holds it.
const CENTRED: f64 = 0.1;

const YOKE: [Watched; 3] = [Watched::YokePitch, Watched::YokeRoll, Watched::YokeHeading];

pub(super) const ENDS: Step = Step {
    number: 20,
    title: "Ctrl-C and kill -9: the controls are released",
    action: "The check ends fccd in flight by SIGINT, as Ctrl-C does, and another by SIGKILL.",
    passes: "Within 1 s both overrides are off and the yoke is centred, or as the joystick holds \
             it; exit code 0 after Ctrl-C.",
    source: "a limit of this project",
    advice: "Switch override_joystick and override_throttles off in X-Plane, and send this report.",
    run: ends,
    restore: |bench| {
        bench.set_switch(false);
        bench.daemon.stop();
    },
};

fn ends(bench: &mut Bench<'_>) -> Done {
    // A daemon that has been in a failsafe ends with another exit code.
    bench.disengage()?;
    bench.daemon.stop();
    for (name, signal) in [("Ctrl-C", Signal::SIGINT), ("kill -9", Signal::SIGKILL)] {
        bench.set_switch(false);
        bench.ready(Guidance::Hold)?;
        let rest = YOKE.map(|yoke| bench.number(yoke));
        bench.engage(Guidance::Hold)?;
        bench.wait("engaged", HELPER_WITHIN)?;
        let sent = Instant::now();
        bench.daemon.signal(signal);
        bench.until(name, Duration::from_secs(4), |b| !b.is_overridden())?;
        let took = if bench.is_overridden() {
            f64::NAN
        } else {
            sent.elapsed().as_secs_f64()
        };
        bench.measure(
            &format!("{name}: until both overrides are off"),
            took,
            "s",
            Limit::AtMost(RELEASED_WITHIN_S),
        );
        bench.wait("the yoke", Duration::from_millis(200))?;
        let off = YOKE.iter().zip(rest).map(|(yoke, rest)| {
            let now = bench.number(*yoke);
            now.abs().min((now - rest).abs())
        });
        let off = off.fold(0.0, f64::max);
        bench.measure(
            &format!("{name}: yoke away from centre and joystick"),
            off,
            "",
            Limit::AtMost(CENTRED),
        );
        let Some(ended) = bench.daemon.ended() else {
            return failed(format!("{name}: fccd did not end within 5 s"));
        };
        if signal == Signal::SIGINT {
            let code = ended.code.map_or(f64::NAN, f64::from);
            bench.measure("exit code after Ctrl-C", code, "", Limit::Between(0.0, 0.0));
        }
    }
    Ok(())
}
