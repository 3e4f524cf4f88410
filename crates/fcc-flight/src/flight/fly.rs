//! Flies an assembly to its end.

use std::io;
use std::net::SocketAddr;
use std::sync::atomic::Ordering;

use fcc_core::framework::State;
use fcc_runtime::{Link, Loop, LoopReport, Machine, Parts, SpawnError};
use fcc_telemetry::recording::RecordingPace;
use fcc_timer::{ManualTimer, Timer, TimerError};

use super::assemble::Assembly;
use super::connection::Connection;
use super::follow::Follower;
use super::hang::HangWatch;
use super::instance_lock::InstanceLock;
use super::live::Live;
use super::plan::{Length, Pace, Plan};
use super::recording::{LoopFacts, Recording, RecordingRequest};
use super::run_statistics::RunStatistics;
use super::signals::{self, Kept};
use super::watch::{Names, Watch};
use super::{Outcome, Pilot};
use crate::config::LoopSection;

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
    /// Another daemon flies this simulator.
    #[error(
        "another fccd on this machine flies X-Plane at {0}: end that one first, or fly another \
         X-Plane"
    )]
    Taken(SocketAddr),
    /// There is no watchdog, and a flight without one was not asked for.
    #[error("the watchdog: {0}")]
    Watchdog(#[source] io::Error),
}

/// Flies an assembly until it is told to stop, by the plan, by a signal
/// (TERM, INT, HUP) or by the aircraft's switch.
///
/// # Errors
/// When the flight does not begin; what happens later is in the outcome.
pub fn fly(
    assembly: Assembly,
    tick: &LoopSection,
    plan: Plan,
    recording: Option<RecordingRequest>,
) -> Result<Outcome, FlyError> {
    let period = tick.period();
    let mut instance_lock = claim(&assembly)?;
    let timer: Box<dyn Timer> = match plan.pace {
        Pace::RealTime => tick.build_timer()?,
        Pace::Lockstep => Box::new(ManualTimer::new(period)?),
    };
    let timer_name = timer.name();
    let guidance = assembly.autopilot.config().guidance;
    let names = Names::of(&assembly);
    let kept = Kept::from_new_threads().map_err(FlyError::Signals)?;
    // There is nothing to watch where time does not pass.
    let live = match plan.pace {
        Pace::RealTime => Live::start(&assembly.telemetry),
        Pace::Lockstep => Live::off(),
    };
    let aircraft = names.aircraft();
    let mut watch = Watch::new(&guidance, assembly.truth, plan, names.clone(), live);
    let mut wish = recording;
    if let Some(wish) = &mut wish {
        let facts = LoopFacts {
            timer: timer_name,
            now_ns: timer.now_ns(),
            sensors: names.sensors,
            actuators: names.actuators,
        };
        wish.prepare(facts, &mut watch);
    }
    // Before the loop's thread exists, so that nothing real-time is inherited.
    let held_at = assembly.x_plane.clone();
    let mut connection = assembly
        .x_plane
        .map(|(status, section)| Connection::watch(status, &section));
    let parts = Parts {
        timer,
        sensors: super::sensors(assembly.sensors),
        controller: super::pilot(assembly.autopilot),
        actuators: assembly.actuators,
    };
    let (report, recording, interrupted) = match plan.pace {
        Pace::RealTime => {
            let (flight_loop, mut link) = Loop::new(parts, &assembly.loop_config)?;
            let interrupted = signals::stop_by(&link.stop).map_err(FlyError::Signals)?;
            let request = &assembly.loop_config.realtime;
            let watchdog =
                HangWatch::start(&assembly.watchdog, period, request.priority, &link, held_at)
                    .map_err(FlyError::Watchdog)?;
            let mut run_statistics = RunStatistics::new(period)?;
            let handle = flight_loop.spawn()?;
            // At once, not only in the report of a flight that may take days.
            for denied in &handle.granted().denied {
                watch.remark(denied.to_string());
            }
            for denied in watchdog.iter().flat_map(|(_, granted)| &granted.denied) {
                watch.remark(format!("watchdog: {denied}"));
            }
            let granted = Some(handle.granted());
            let mut recording =
                wish.and_then(|wish| wish.begin(granted, RecordingPace::RealTime, &mut watch));
            drop(kept);
            watch.live.describe(tick, handle.granted(), &aircraft);
            let news = watch.begin_restart(assembly.restart);
            let watched_by = watchdog.as_ref().map(|(watchdog, _)| watchdog);
            let hung = Follower {
                link: &mut link,
                watch: &mut watch,
                recording: recording.as_mut(),
                run_statistics: Some(&mut run_statistics),
                instance_lock: instance_lock.as_mut(),
                plan,
            }
            .follow(connection.as_mut(), watched_by, news);
            watch.service.stopping();
            let report = match hung {
                None => handle.join(),
                Some(hung) => {
                    let granted = handle.granted().clone();
                    handle.abandon();
                    // Not dismissed, the guard gives the controls back once
                    // more: a loop that wakes up now may yet take them.
                    connection = None;
                    run_statistics.report(hung, timer_name, granted)
                }
            };
            (report, recording, interrupted)
        }
        Pace::Lockstep => {
            let (machine, mut link) = Machine::new(parts, &assembly.loop_config)?;
            let interrupted = signals::stop_by(&link.stop).map_err(FlyError::Signals)?;
            let mut recording =
                wish.and_then(|wish| wish.begin(None, RecordingPace::Lockstep, &mut watch));
            drop(kept);
            let report = run_in_lockstep(machine, &mut link, &mut watch, recording.as_mut(), plan)?;
            (report, recording, interrupted)
        }
    };
    let report = give_back(report, connection, &mut watch);
    // The controls were given back before; the disk may take its time now.
    let recording =
        recording.map(|recording| recording.end(&report.ending.to_string(), &mut watch));
    // A beacon may have led to where another daemon flies.
    refuse_if_taken(instance_lock.as_ref().filter(|_| report.released))?;
    let refused = watch.was_refused() && !matches!(plan.length, Length::Open);
    let (events, log) = watch.into_parts();
    // A flight with a leg that was not flown to its end has no score.
    let score = log.and_then(|log| log.score().ok());
    let mut outcome = Outcome::new(timer_name, report, events, score, recording);
    outcome.explain(interrupted.load(Ordering::Relaxed), refused);
    Ok(outcome)
}

/// Claims the simulator for this process, if it is one and known already.
fn claim(assembly: &Assembly) -> Result<Option<InstanceLock>, FlyError> {
    let x_plane = assembly.x_plane.as_ref();
    let instance_lock = x_plane.map(|(status, _)| InstanceLock::of(status.clone()));
    refuse_if_taken(instance_lock.as_ref()).map(|()| instance_lock)
}

fn refuse_if_taken(instance_lock: Option<&InstanceLock>) -> Result<(), FlyError> {
    match instance_lock.and_then(InstanceLock::taken) {
        Some(simulator) => Err(FlyError::Taken(simulator)),
        None => Ok(()),
    }
}

/// Waits until X-Plane shows that it has its controls back, and says in the
/// report whether it does.
fn give_back(report: LoopReport, connection: Option<Connection>, watch: &mut Watch) -> LoopReport {
    let confirmed = connection.is_none_or(Connection::end);
    if let Some(restart) = watch.restart.take() {
        restart.end();
    }
    if !confirmed {
        watch.remark(
            "X-Plane did not show that it has its controls back; the guard process goes on \
             trying for two minutes"
                .to_owned(),
        );
    }
    LoopReport {
        released: report.released && confirmed,
        ..report
    }
}

fn run_in_lockstep(
    mut machine: Machine<Pilot>,
    link: &mut Link<Pilot>,
    watch: &mut Watch,
    recording: Option<&mut Recording>,
    plan: Plan,
) -> Result<LoopReport, FlyError> {
    machine.start()?;
    let mut follower = Follower {
        link,
        watch,
        recording,
        run_statistics: None,
        instance_lock: None,
        plan,
    };
    while machine.step() != State::Stopped {
        follower.drain();
    }
    let report = machine.finish();
    follower.drain();
    Ok(report)
}
