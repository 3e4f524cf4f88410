//! How an X-Plane aircraft responds to its controls, and the gains that follow.
//!
//! The daemon flies level, or a person where the gains are not good enough for
//! that. For each control both let go, the check holds the controls where they
//! were, deflects one of them, and gives them back. An aircraft that responds half as much as the Cessna 172
//! on which the gains were tuned needs gains twice as large:
//! `[autopilot.scale]`, as a first guess.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use fcc_xplane::{PlantId, plant_at};
use serde::Serialize;

use crate::bench::{Bench, ENGAGES_WITHIN, Stop, failed};
use crate::check::{CheckError, Request, open};
use crate::configuration::Guidance;
use crate::disturbance::{disturbance, other_time_rate};
use crate::envelope::Envelope;
use crate::screen::Screen;
use crate::watched::Watched;

/// The interval of writes: faster than frames.
const WRITE_EVERY: Duration = Duration::from_millis(15);
/// How long the controls are held before a deflection.
const REST: Duration = Duration::from_millis(300);
/// How long the daemon makes sure of its release.
const RELEASED: Duration = Duration::from_millis(500);
/// The interval between two releases.
const RELEASE_AGAIN_AFTER: Duration = Duration::from_millis(250);
/// How long X-Plane's first answer may take.
const ANSWERS_WITHIN: Duration = Duration::from_secs(5);
/// How long level flight may take to become steady.
const STEADY_WITHIN: Duration = Duration::from_secs(40);
/// How long it has to be.
const STEADY_FOR: Duration = Duration::from_secs(3);
const KNOT_MPS: f64 = 0.514_444;

/// A control, its deflection, and the response of the Cessna 172.
struct Control {
    name: &'static str,
    written: Watched,
    /// What responds.
    response: Watched,
    /// In X-Plane's unit to SI.
    to_si: f64,
    deflection: f64,
    lasts: Duration,
    /// Whether the value itself is the response after the time, or its change
    /// per second.
    is_rate: bool,
    /// JSBSim's c172p: response for a full deflection, as
    /// `hil/fcc_hil/tuning/identify.py` measures it with the same deflection and
    /// time, at 100 kt.
    reference: f64,
}

const CONTROLS: [Control; 4] = [
    Control {
        name: "elevator",
        written: Watched::YokePitch,
        response: Watched::PitchRate,
        to_si: 1.0,
        deflection: 0.08,
        lasts: Duration::from_millis(600),
        is_rate: false,
        reference: 0.621,
    },
    Control {
        name: "aileron",
        written: Watched::YokeRoll,
        response: Watched::RollRate,
        to_si: 1.0,
        deflection: 0.08,
        lasts: Duration::from_millis(600),
        is_rate: false,
        reference: 1.095,
    },
    Control {
        name: "rudder",
        written: Watched::YokeHeading,
        response: Watched::YawRate,
        to_si: 1.0,
        deflection: 0.08,
        lasts: Duration::from_millis(600),
        is_rate: false,
        reference: 0.417,
    },
    Control {
        name: "throttle",
        written: Watched::Throttle,
        response: Watched::Airspeed,
        to_si: KNOT_MPS,
        deflection: 0.1,
        lasts: Duration::from_secs(4),
        is_rate: true,
        reference: 3.75,
    },
];

/// Scales beyond these mean a control without effect, or another's.
const LEAST: f64 = 0.05;
const MOST: f64 = 20.0;

/// The response to one control.
#[derive(Clone, Debug, Serialize)]
pub struct Response {
    /// `elevator`, `aileron`, `rudder` or `throttle`.
    pub control: &'static str,
    /// For a full deflection: rad/s after 0.6 s; of the throttle m/s².
    pub response: f64,
    /// The same of the Cessna 172 on which the gains were tuned.
    pub reference: f64,
    /// For `[autopilot.scale]`.
    pub scale: f64,
}

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// Indicated airspeed.
    pub airspeed_kt: f64,
    /// Of each control.
    pub responses: Vec<Response>,
}

impl Identified {
    /// Lines for the configuration.
    pub fn toml(&self) -> String {
        let mut text = format!(
            "[autopilot]\nreference_airspeed_kt = {:.0}.0\n\n[autopilot.scale]\n",
            self.airspeed_kt
        );
        for found in &self.responses {
            let _ = writeln!(text, "{} = {:.3}", found.control, found.scale);
        }
        text
    }
}

/// Why nothing was found.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum IdentifyError {
    /// It could not begin.
    #[error(transparent)]
    NotBegun(#[from] CheckError),
    /// It ended early; the controls were released.
    #[error("{0}")]
    Ended(String),
}

/// Who flies between the deflections.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum FlownBy {
    /// The daemon: its gains have to be good enough for level flight.
    Daemon,
    /// A person, hands off the trimmed aircraft when it is steady.
    Person,
}

/// Deflects one control after another in level flight, and returns how the
/// aircraft responds. It must fly level already, in calm air.
///
/// `held` is called with X-Plane before the measurement itself takes its
/// controls, and with none after X-Plane has confirmed their release: a caller
/// that is killed between the two needs another process to release them. If it returns
/// false, they are not taken. `is_flown` is as that of [`check`](crate::check).
///
/// # Errors
/// If it could not begin, or if it was ended: by the envelope, by a control
/// without effect, or by a signal.
pub fn identify(
    request: Request,
    by: FlownBy,
    screen: &mut dyn Screen,
    held: &mut dyn FnMut(Option<PlantId>) -> bool,
    is_flown: &dyn Fn(&PlantId) -> bool,
) -> Result<Identified, IdentifyError> {
    let mut bench = open(request, screen, is_flown)?;
    let found = fly(&mut bench, by, held).map_err(|stop| {
        IdentifyError::Ended(match stop {
            Stop::Failed(why) | Stop::NotReady(why) | Stop::Skipped(why) => why,
            Stop::Quit => "ended by a signal".to_owned(),
        })
    });
    bench.set_switch(false);
    bench.daemon.stop();
    found
}

fn fly(
    bench: &mut Bench<'_>,
    by: FlownBy,
    held: &mut dyn FnMut(Option<PlantId>) -> bool,
) -> Result<Identified, Stop> {
    begins(bench)?;
    let mut responses = Vec::new();
    let mut airspeed_kt = f64::NAN;
    for control in &CONTROLS {
        steady(bench, by)?;
        airspeed_kt = bench.number(Watched::Airspeed);
        if !held(plant_at(bench.link.simulator())) {
            return failed("another fccd flies this X-Plane: end it first".to_owned());
        }
        let flown = deflect(bench, control);
        let released = release(bench);
        if released.is_ok() {
            held(None);
        }
        let response = flown? / control.deflection;
        released?;
        let ratio = control.reference / response;
        if !(LEAST..=MOST).contains(&ratio) {
            return failed(format!(
                "the {} has no effect, or the opposite one: {response:.3} for a full deflection, \
                 the Cessna's {}",
                control.name, control.reference
            ));
        }
        responses.push(Response {
            control: control.name,
            response,
            reference: control.reference,
            scale: ratio,
        });
    }
    // It leaves the aircraft in steady flight.
    steady(bench, by)?;
    bench.disengage()?;
    Ok(Identified {
        airspeed_kt,
        responses,
    })
}

/// Waits until X-Plane answers, and refuses a state in which nothing can be
/// measured.
fn begins(bench: &mut Bench<'_>) -> Result<(), Stop> {
    bench.until("waiting for X-Plane", ANSWERS_WITHIN, |b| {
        b.link.latest().is_some()
    })?;
    if bench.link.latest().is_none() {
        return failed(format!(
            "nothing arrives from X-Plane at {}: start it; `fccd run` says why if it runs",
            bench.link.simulator()
        ));
    }
    // The first frames, with all values.
    bench.wait("X-Plane answers", REST)?;
    undisturbed(bench)
}

fn undisturbed(bench: &Bench<'_>) -> Result<(), Stop> {
    disturbance(bench.link.latest(), Instant::now()).map_or(Ok(()), failed)
}

/// Waits until the flight is steady.
fn steady(bench: &mut Bench<'_>, by: FlownBy) -> Result<(), Stop> {
    if by == FlownBy::Daemon {
        bench.engage(Guidance::Hold)?;
    }
    let mut since = Instant::now();
    let is_steady = bench.until("steady level flight", STEADY_WITHIN, |b| {
        let rates = [Watched::RollRate, Watched::PitchRate, Watched::YawRate];
        let calm = rates.iter().all(|rate| b.number(*rate).abs() < 0.03)
            && b.number(Watched::Roll).abs() < 3.0
            && b.number(Watched::ClimbRate).abs() < 150.0
            && disturbance(b.link.latest(), Instant::now()).is_none();
        if !calm {
            since = Instant::now();
        }
        since.elapsed() >= STEADY_FOR
    })?;
    if is_steady {
        return Ok(());
    }
    undisturbed(bench)?;
    failed(
        "the flight does not become steady: fly in calm air, trimmed; if fccd does not hold it \
         steady, fly yourself, with --by-hand",
    )
}

/// The controls, as they were held.
struct Held([(Watched, f64); 4]);

impl Held {
    fn now(bench: &Bench<'_>) -> Self {
        Self(CONTROLS.map(|control| (control.written, bench.number(control.written))))
    }

    /// Writes them, one with a deflection.
    fn write(&self, bench: &Bench<'_>, deflected: Watched, deflection: f64) {
        for (what, value) in self.0 {
            let more = if what == deflected { deflection } else { 0.0 };
            bench.link.write_control(what, value + more);
        }
    }
}

/// Takes the controls, deflects one of them up and down, and returns half the
/// difference of the responses.
fn deflect(bench: &mut Bench<'_>, control: &Control) -> Result<f64, Stop> {
    let held = Held::now(bench);
    let limits = Envelope::now(bench);
    bench.disengage()?;
    bench.wait("released", RELEASED)?;
    let began = bench.link.latest().copied();
    hold(bench, &held, &limits, (control.written, 0.0), REST)?;
    let mut responses = [0.0; 2];
    for (response, sign) in responses.iter_mut().zip([1.0, -1.0]) {
        let before = bench.number(control.response);
        let deflection = (control.written, sign * control.deflection);
        hold(bench, &held, &limits, deflection, control.lasts)?;
        *response = (bench.number(control.response) - before) * control.to_si;
        if control.is_rate {
            *response /= control.lasts.as_secs_f64();
        }
        // A surface's rate swings back before the other deflection.
        if !control.is_rate {
            break;
        }
    }
    if let Some(why) = began
        .zip(bench.link.latest())
        .and_then(|(first, last)| other_time_rate(&first, last))
    {
        return failed(why);
    }
    let [up, down] = responses;
    Ok(if control.is_rate {
        (up - down) / 2.0
    } else {
        up
    })
}

/// Writes the controls for a time, within the envelope.
fn hold(
    bench: &mut Bench<'_>,
    held: &Held,
    limits: &Envelope,
    (deflected, deflection): (Watched, f64),
    duration: Duration,
) -> Result<(), Stop> {
    let until = Instant::now() + duration;
    while Instant::now() < until {
        // Each time: the daemon clears an override that is set soon after its release, as a
        // late write of its own, until the yoke moves to where it did not put it.
        for what in [Watched::OverrideJoystick, Watched::OverrideThrottles] {
            bench.link.write(bench.link.path(what), 1.0);
        }
        held.write(bench, deflected, deflection);
        bench.wait("deflected", WRITE_EVERY)?;
        undisturbed(bench)?;
        limits.check(bench)?;
    }
    Ok(())
}

/// Gives the controls back, however it went, until X-Plane confirms it.
fn release(bench: &mut Bench<'_>) -> Result<(), Stop> {
    let until = Instant::now() + ENGAGES_WITHIN;
    while Instant::now() < until {
        for what in [Watched::YokePitch, Watched::YokeRoll, Watched::YokeHeading] {
            bench.link.write(bench.link.path(what), 0.0);
        }
        for what in [Watched::OverrideJoystick, Watched::OverrideThrottles] {
            bench.link.write(bench.link.path(what), 0.0);
        }
        bench.link.poll(RELEASE_AGAIN_AFTER);
        if !bench.is_overridden() && !bench.link.is_silent_for(RELEASE_AGAIN_AFTER) {
            return Ok(());
        }
    }
    failed("X-Plane has not confirmed the release of the controls")
}
