//! Flies an assembly to its end.

use std::io;
use std::thread;
use std::time::Duration;

use fcc_core::framework::State;
use fcc_runtime::{Link, Loop, LoopReport, Machine, Parts, SpawnError};
use fcc_timer::{ManualTimer, Timer, TimerError, TimerKind};

use super::assemble::Assembly;
use super::connection::Connection;
use super::live::Live;
use super::signals::{self, Kept};
use super::watch::{Names, Watch};
use super::{Outcome, Pilot};
use crate::config::LoopSection;

/// How fast time passes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Pace {
    /// As it does.
    RealTime,
    /// As fast as the machine can: each tick follows the last at once.
    Lockstep,
}

/// How a flight is to go.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// How fast time passes.
    pub pace: Pace,
    /// Stop so many seconds after engaging; none to fly until told to stop.
    pub seconds: Option<f64>,
    /// No status lines.
    pub quiet: bool,
    /// Whether to print events as they happen.
    pub announce: bool,
}

/// Why a flight did not begin.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum FlyError {
    /// The loop's timer cannot be had.
    #[error("the loop's timer: {0}")]
    Timer(#[from] TimerError),
    /// The loop's thread could not start.
    #[error(transparent)]
    Spawn(#[from] SpawnError),
    /// Signals cannot be caught, and a flight that cannot be told to end does
    /// not begin.
    #[error("signals cannot be caught: {0}")]
    Signals(#[source] io::Error),
}

/// How often what the loop tells is fetched: often enough to look alive, and
/// seldom enough to cost nothing.
const FETCH_EVERY: Duration = Duration::from_millis(20);

/// Flies an assembly until it is told to stop, by the plan, by a signal
/// (TERM, INT, HUP) or by the aircraft's switch.
///
/// # Errors
/// When the flight does not begin; what happens later is in the outcome.
pub fn fly(assembly: Assembly, tick: &LoopSection, plan: Plan) -> Result<Outcome, FlyError> {
    let period = tick.period();
    let timer: Box<dyn Timer> = match plan.pace {
        Pace::RealTime => build(tick.timer, period)?,
        Pace::Lockstep => Box::new(ManualTimer::new(period)?),
    };
    let timer_name = timer.name();
    let course = assembly.autopilot.config().course;
    let names = Names::of(&assembly);
    let kept = Kept::from_new_threads().map_err(FlyError::Signals)?;
    // There is nothing to watch where time does not pass.
    let live = match plan.pace {
        Pace::RealTime => Live::start(&assembly.telemetry),
        Pace::Lockstep => Live::off(),
    };
    let aircraft = names.aircraft();
    let mut watch = Watch::new(&course, assembly.truth, plan, names, live);
    // Before the loop's thread exists, so that nothing real-time is inherited.
    let mut connection = assembly
        .x_plane
        .map(|(status, section)| Connection::watch(status, &section));
    let parts = Parts {
        timer,
        sensors: assembly.sensors,
        controller: super::pilot(assembly.autopilot),
        actuators: assembly.actuators,
    };
    let report = match plan.pace {
        Pace::RealTime => {
            let (flight_loop, mut link) = Loop::new(parts, &assembly.loop_config)?;
            signals::stop_by(&link.stop).map_err(FlyError::Signals)?;
            let handle = flight_loop.spawn()?;
            drop(kept);
            watch.live.describe(tick, handle.grants(), &aircraft);
            while !link.messages.is_over() {
                drain(&mut link, &mut watch, plan);
                if let Some(words) = connection.as_mut().and_then(Connection::poll) {
                    watch.remark(words);
                }
                if let Some(words) = watch.live.poll() {
                    watch.remark(words);
                }
                thread::sleep(FETCH_EVERY);
            }
            drain(&mut link, &mut watch, plan);
            handle.join()
        }
        Pace::Lockstep => {
            let (machine, mut link) = Machine::new(parts, &assembly.loop_config)?;
            signals::stop_by(&link.stop).map_err(FlyError::Signals)?;
            drop(kept);
            run_in_lockstep(machine, &mut link, &mut watch, plan)?
        }
    };
    if let Some(connection) = connection {
        connection.end(report.released);
    }
    let (events, log) = watch.into_parts();
    // A flight with a leg that was not flown to its end has no score.
    let score = log.and_then(|log| log.score().ok());
    Ok(Outcome::new(timer_name, report, events, score))
}

fn build(kind: TimerKind, period: Duration) -> Result<Box<dyn Timer>, TimerError> {
    kind.build(period)
}

fn run_in_lockstep(
    mut machine: Machine<Pilot>,
    link: &mut Link<Pilot>,
    watch: &mut Watch,
    plan: Plan,
) -> Result<LoopReport, FlyError> {
    machine.start()?;
    while machine.step() != State::Stopped {
        drain(link, watch, plan);
    }
    let report = machine.finish();
    drain(link, watch, plan);
    Ok(report)
}

/// Fetches all there is, and stops the loop when its time is up.
fn drain(link: &mut Link<Pilot>, watch: &mut Watch, plan: Plan) {
    while let Some(message) = link.messages.receive() {
        watch.take(&message);
        let time_is_up = plan
            .seconds
            .zip(watch.engaged_for_s())
            .is_some_and(|(most, flown)| flown >= most - 1e-6);
        // A flight of a given length that fails has no length any more.
        if time_is_up || (plan.seconds.is_some() && watch.failed()) {
            link.stop.stop();
        }
    }
}
