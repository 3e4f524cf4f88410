//! Steps 12 to 14: the simulator stops by itself or by a person: pause, map,
//! settings, replay.

use std::time::{Duration, Instant};

use super::engaging::{BANK_DEG, extreme};
use super::paths;
use crate::bench::{Bench, Done, failed};
use crate::configuration::Guidance;
use crate::figure::Limit;
use crate::link::Sample;
use crate::step::Step;
use crate::watched::Watched;

/// How long X-Plane may take to carry out a command before a person is asked.
const CARRIED_OUT_WITHIN: Duration = Duration::from_secs(3);
const NO_ALARM: &str = "fccd has taken this for a fault: send this report.";

pub(super) const PAUSE: Step = Step {
    number: 12,
    title: "a pause of 20 s",
    action: "The check pauses X-Plane, and lets it run again.",
    passes: "The overrides stay on, there is no failsafe, and the flight continues as it was.",
    source: "limits of this project: no failsafe, a step of at most 5° of bank",
    advice: NO_ALARM,
    run: pause,
    restore: |bench| {
        if bench.number(Watched::Paused) >= 0.5 {
            bench.link.command(paths::PAUSE);
        }
    },
};

fn pause(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    toggle(
        bench,
        paths::PAUSE,
        "Pause X-Plane.",
        "it is paused",
        is_paused,
    )?;
    bench.wait("paused", bench.waits.pause)?;
    toggle(
        bench,
        paths::PAUSE,
        "Let X-Plane run again.",
        "it runs",
        |b| !is_paused(b),
    )?;
    flight.continues(bench)
}

fn is_paused(bench: &Bench<'_>) -> bool {
    bench.number(Watched::Paused) >= 0.5
}

pub(super) const WINDOWS: Step = Step {
    number: 13,
    title: "map and settings open, 20 s each",
    action: "The check opens X-Plane's map and closes it, then its settings.",
    passes: "As in a pause, whether or not X-Plane's time stops meanwhile.",
    source: "windows may stop the model without `paused` (X-Plane's SDK, Simulated_Time)",
    advice: NO_ALARM,
    run: windows,
    restore: |bench| {
        let _ = runs_again(bench);
    },
};

fn windows(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    for (name, command, open, close) in [
        ("map", paths::MAP, "Open the map.", "Close the map."),
        (
            "settings",
            paths::SETTINGS,
            "Open the settings.",
            "Close the settings.",
        ),
    ] {
        let since = Instant::now();
        let from = bench.number(Watched::FlightTime);
        window(bench, command, open)?;
        bench.wait(&format!("{name} open"), bench.waits.window)?;
        let ran_s = bench.number(Watched::FlightTime) - from;
        bench.measure(
            &format!("{name}: X-Plane's time while it was open"),
            ran_s / since.elapsed().as_secs_f64(),
            "s/s",
            Limit::Noted,
        );
        window(bench, command, close)?;
        runs_again(bench)?;
    }
    flight.continues(bench)
}

/// X-Plane may keep its time running while a window is open, so an open window
/// is not seen from here: a person confirms it.
fn window(bench: &mut Bench<'_>, command: &str, instruction: &str) -> Done {
    bench.link.command(command);
    if bench.is_unattended {
        return Ok(());
    }
    bench.have_confirmed(
        "window",
        &format!("{instruction} If it is already so, press Enter."),
    )
}

/// Waits until X-Plane's time runs.
fn runs_again(bench: &mut Bench<'_>) -> Done {
    let from = bench.number(Watched::FlightTime);
    bench.expect("X-Plane's time runs again", CARRIED_OUT_WITHIN * 2, |b| {
        !b.link.is_silent_for(Duration::from_millis(300))
            && (b.number(Watched::FlightTime) - from).abs() > 0.1
    })
}

pub(super) const REPLAY: Step = Step {
    number: 14,
    title: "a replay of 10 s",
    action: "The check switches X-Plane's replay on and off.",
    passes: "No failsafe; back in the flight, fccd flies on or has released the controls and says \
             why.",
    source: "a rule of this project: flown on if the aircraft is where it was, otherwise released",
    advice: NO_ALARM,
    run: replay,
    restore: |bench| {
        if is_in_replay(bench) {
            bench.link.command(paths::REPLAY);
        }
    },
};

fn is_in_replay(bench: &Bench<'_>) -> bool {
    bench.number(Watched::InReplay) >= 0.5
}

fn replay(bench: &mut Bench<'_>) -> Done {
    let flight = Flight::begin(bench)?;
    toggle(
        bench,
        paths::REPLAY,
        "Switch the replay on.",
        "it is in replay",
        is_in_replay,
    )?;
    bench.wait("replay", bench.waits.replay)?;
    toggle(
        bench,
        paths::REPLAY,
        "Switch the replay off.",
        "it is out of replay",
        |b| !is_in_replay(b),
    )?;
    bench.wait("back in the flight", bench.waits.watch)?;
    if bench.is_held() {
        return flight.continues(bench);
    }
    if !bench.has_said(flight.since, &["engaged -> standby"]) {
        return failed("after the replay the overrides are off, and fccd has not said why");
    }
    bench.note("fccd released the controls after the replay");
    flight.without_failsafe(bench)
}

/// Sends a command whose effect is seen; asks a person if it has none.
fn toggle(
    bench: &mut Bench<'_>,
    command: &str,
    instruction: &str,
    what: &str,
    holds: impl Fn(&Bench<'_>) -> bool,
) -> Done {
    bench.link.command(command);
    if bench.until(what, CARRIED_OUT_WITHIN, &holds)? {
        return Ok(());
    }
    if bench.is_unattended {
        return failed(format!("{command} has no effect: not {what}"));
    }
    bench.have_done("toggle", instruction, what, holds)
}

/// A flight in a hold that something interrupts.
pub(super) struct Flight {
    pub(super) since: Instant,
    before: Sample,
}

impl Flight {
    /// Engages, and notes the state.
    pub(super) fn begin(bench: &mut Bench<'_>) -> Result<Self, crate::bench::Stop> {
        bench.engage(Guidance::Hold)?;
        bench.wait("steady", Duration::from_millis(300))?;
        match bench.link.latest() {
            Some(before) => Ok(Self {
                since: Instant::now(),
                before: *before,
            }),
            None => failed("nothing arrives from X-Plane"),
        }
    }

    /// The flight goes on as it was: watched for a while.
    pub(super) fn continues(&self, bench: &mut Bench<'_>) -> Done {
        bench.wait("the flight continues", bench.waits.watch)?;
        self.is_held(bench);
        let bank = extreme(bench, self.since, |sample| {
            (sample.number(Watched::Roll) - self.before.number(Watched::Roll)).abs()
        });
        let climb =
            (bench.number(Watched::Elevation) - self.before.number(Watched::Elevation)).abs();
        bench.measure("change of bank", bank, "°", Limit::AtMost(BANK_DEG));
        bench.measure(
            "change of height",
            climb / 0.3048,
            "ft",
            Limit::AtMost(20.0),
        );
        self.without_failsafe(bench)
    }

    /// The overrides were on throughout.
    pub(super) fn is_held(&self, bench: &mut Bench<'_>) {
        let samples = bench.link.since(self.since);
        let dropped = samples.filter(|sample| !sample.is_held()).count() as f64;
        bench.measure(
            "replies without both overrides",
            dropped,
            "",
            Limit::AtMost(0.0),
        );
    }

    /// The daemon has not reported a failsafe.
    pub(super) fn without_failsafe(&self, bench: &Bench<'_>) -> Done {
        let lines = bench.daemon.since(self.since);
        match lines.iter().find(|line| line.text.contains("-> failsafe")) {
            Some(line) => failed(line.text.trim()),
            None => Ok(()),
        }
    }
}
