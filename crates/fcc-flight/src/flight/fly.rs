//! Flies an assembly to its end.

use std::io;
use std::sync::Arc;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released, State};
use fcc_fixed_wing::Autopilot;
use fcc_guidance::Mode;
use fcc_runtime::{Ending, Link, Loop, LoopReport, Machine, Parts, SpawnError, WatchdogConfig};
use fcc_timer::{ManualTimer, RealtimeGranted, Timer, TimerError};

use super::assemble::Assembly;
use super::follow::Follower;
use super::ground::GroundWatch;
use super::hang::HangWatch;
use super::host::Host;
use super::observer::{Facts, Observer};
use super::observer_list::Names;
use super::observers::Observers;
use super::outcome::{Outcome, Over};
use super::pilot::Pilot;
use super::plan::{Length, Pace, Plan};
use super::run_statistics::RunStatistics;
use crate::config::{LoopSection, WatchdogSection};

/// How long the end of a flight waits for the plant to confirm the release of
/// its controls. Sending a release is not enough: a simulator that hangs loses
/// it, and would continue with its controls held.
const GIVE_BACK_WITHIN: Duration = Duration::from_secs(5);

/// Why a flight did not begin.
#[derive(thiserror::Error, Debug)]
#[non_exhaustive]
pub enum FlyError {
    /// The loop's timer cannot be created.
    #[error("the loop's timer: {0}")]
    Timer(#[from] TimerError),
    /// The loop's thread could not start.
    #[error(transparent)]
    Spawn(#[from] SpawnError),
    /// The host program cannot fly.
    #[error(transparent)]
    Host(io::Error),
    /// Another program controls this plant.
    #[error("another fccd on this machine flies {0}: end that one first, or fly another")]
    Taken(PlantId),
    /// There is no watchdog, and a flight without one was not requested.
    #[error("the watchdog: {0}")]
    Watchdog(#[source] io::Error),
}

/// Flies an assembly until it is stopped by the plan, by the host program or by
/// the aircraft's switch.
///
/// # Errors
/// When the flight does not begin; what happens later is in the outcome.
pub fn fly(
    assembly: Assembly,
    tick: &LoopSection,
    plan: Plan,
    observers: Vec<Box<dyn Observer<Autopilot>>>,
    host: &mut dyn Host,
) -> Result<Outcome, FlyError> {
    let period = tick.period();
    let authority = assembly.authority.clone();
    host.prepare(authority.as_ref()).map_err(FlyError::Host)?;
    refuse_if_taken(host)?;
    let timer: Box<dyn Timer> = match plan.pace {
        Pace::RealTime => tick.build_timer()?,
        Pace::Lockstep => Box::new(ManualTimer::new(period)?),
    };
    let timer_name = timer.name();
    let names = Names::of(&assembly.sensors, &assembly.actuators);
    let autopilot = assembly.autopilot.config();
    let flies_plan = autopilot.guidance.mode() == Mode::Plan;
    let has_end = autopilot.plan.is_none_or(|route| route.has_end());
    let mut observers = Observers::new(observers, names.clone());
    observers.list.prepare();
    let started_unix_ns = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos() as u64);
    let facts = Facts {
        rate_hz: tick.rate_hz,
        timer: timer_name,
        sensors: &names.sensors,
        actuators: &names.actuators,
        started_unix_ns,
        clock_offset_ns: (started_unix_ns as i64).saturating_sub(timer.now_ns()),
        pace: plan.pace,
        granted: None,
    };
    #[cfg_attr(
        not(feature = "fault-injection"),
        expect(unused_mut, reason = "a fault is a further sensor")
    )]
    let mut sensors = assembly.sensors;
    #[cfg(feature = "fault-injection")]
    sensors.push(Box::new(super::injection::Blocking::default()));
    let parts = Parts {
        timer,
        sensors,
        controller: Pilot::new(*assembly.autopilot, assembly.control),
        actuators: assembly.actuators,
    };
    let mut ground = GroundWatch::new(assembly.true_now);
    let report = match plan.pace {
        Pace::RealTime => {
            let (flight_loop, link) = Loop::new(parts, &assembly.loop_config)?;
            host.attach(&link.stop).map_err(FlyError::Host)?;
            RealTime {
                flight_loop,
                link,
                period,
                watchdog: &assembly.watchdog,
                loop_priority: assembly.loop_config.realtime.priority,
                authority: authority.as_ref(),
                length: plan.length,
                ground: &mut ground,
            }
            .run(facts, &mut observers, host)?
        }
        Pace::Lockstep => {
            let (machine, mut link) = Machine::new(parts, &assembly.loop_config)?;
            host.attach(&link.stop).map_err(FlyError::Host)?;
            observers.list.begin(&facts);
            host.started();
            run_in_lockstep(
                machine,
                &mut link,
                &mut observers,
                host,
                plan.length,
                &mut ground,
            )?
        }
    };
    let report = await_release(report, authority.as_ref(), &mut observers, host);
    let released = report.released;
    let mut outcome = Outcome::new(timer_name, plan.pace, &report);
    if let Some(impact) = ground.impact {
        outcome.hit_ground(impact);
    } else if matches!(report.ending, Ending::StopFlag) {
        let over = observers.list.monitor.over(plan.length);
        let interrupted = host.interrupted_by();
        outcome.explain(interrupted, over, observers.refusal.as_deref());
        let is_flown = !flies_plan || observers.list.monitor.plan.is_flown;
        let over = over.filter(|over| match over {
            Over::Time => has_end,
            over => *over == Over::GivenUp,
        });
        if let Some(over) = over.filter(|_| interrupted.is_none() && !is_flown) {
            outcome.was_not_flown(observers.flown, observers.given_up.as_deref(), over);
        }
    }
    // The controls have been released; writing to the disk may take time now.
    let ending = outcome.ending.clone();
    observers.list.end(&ending, &mut outcome);
    // A beacon may have led to a simulator that another program controls.
    if released {
        refuse_if_taken(host)?;
    }
    Ok(outcome)
}

pub(super) fn refuse_if_taken(host: &dyn Host) -> Result<(), FlyError> {
    host.taken_by_another()
        .map_or(Ok(()), |plant| Err(FlyError::Taken(plant)))
}

/// A loop to be run in its own thread.
struct RealTime<'a> {
    flight_loop: Loop<Pilot>,
    link: Link<Pilot>,
    period: Duration,
    watchdog: &'a WatchdogSection,
    loop_priority: Option<u8>,
    authority: Option<&'a Arc<dyn ControlAuthority>>,
    length: Length,
    ground: &'a mut GroundWatch,
}

impl RealTime<'_> {
    fn run(
        mut self,
        facts: Facts<'_>,
        observers: &mut Observers,
        host: &mut dyn Host,
    ) -> Result<LoopReport, FlyError> {
        let (mut watchdog, watchdog_granted) = if self.watchdog.enabled {
            let config = WatchdogConfig {
                hang_after: self.watchdog.hang_after(self.period),
                loop_priority: self.loop_priority,
            };
            HangWatch::start(&config, &self.link, self.authority.cloned(), host)
                .map(|(watchdog, granted)| (Some(watchdog), Some(granted)))
                .map_err(FlyError::Watchdog)?
        } else {
            (None, None)
        };
        let mut run_statistics = RunStatistics::<Pilot>::new(self.period)?;
        // Before the first tick: of a simulator on this machine only what is its user's
        // is received.
        if let Some(authority) = self.authority {
            authority.report(&mut |words| observers.list.remark(words.to_string()));
        }
        let handle = self.flight_loop.spawn()?;
        let granted = handle.granted().clone();
        // Reported at once, not only at the end of a flight that may take days.
        report_denied(&granted, watchdog_granted.as_ref(), observers);
        observers.list.begin(&Facts {
            granted: Some(&granted),
            ..facts
        });
        host.started();
        let hung = Follower {
            link: &mut self.link,
            observers,
            host,
            run_statistics: Some(&mut run_statistics),
            length: self.length,
            ground: self.ground,
        }
        .follow(self.authority, watchdog.as_mut());
        observers.list.stopping();
        Ok(match hung {
            None => handle.join(),
            Some(hung) => {
                handle.abandon();
                run_statistics.report(hung, facts.timer, granted)
            }
        })
    }
}

fn report_denied(
    granted: &RealtimeGranted,
    of_watchdog: Option<&RealtimeGranted>,
    observers: &mut Observers,
) {
    for denied in &granted.denied {
        observers.list.remark(denied.to_string());
    }
    for denied in of_watchdog.iter().flat_map(|granted| &granted.denied) {
        observers.list.remark(format!("watchdog: {denied}"));
    }
}

fn run_in_lockstep(
    mut machine: Machine<Pilot>,
    link: &mut Link<Pilot>,
    observers: &mut Observers,
    host: &mut dyn Host,
    length: Length,
    ground: &mut GroundWatch,
) -> Result<LoopReport, FlyError> {
    machine.start()?;
    let (ticks, length) = match length {
        Length::Ticks(ticks) => (ticks, Length::Open),
        other => (u64::MAX, other),
    };
    let mut follower = Follower {
        link,
        observers,
        host,
        run_statistics: None,
        length,
        ground,
    };
    while machine.step() != State::Stopped {
        follower.drain();
        if machine.record().tick.number >= ticks {
            break;
        }
    }
    let report = machine.finish();
    follower.drain();
    Ok(report)
}

/// Waits until the plant confirms the release of its controls, if they were
/// taken, and stores in the report whether it did.
fn await_release(
    report: LoopReport,
    authority: Option<&Arc<dyn ControlAuthority>>,
    observers: &mut Observers,
    host: &mut dyn Host,
) -> LoopReport {
    // After a hang the watchdog has released the controls, but the loop might
    // still take them again, so the host keeps its release helper.
    if matches!(report.ending, Ending::Hung) {
        host.end(Released::Unconfirmed);
        return report;
    }
    let released = release_by(authority, &mut |words| observers.list.remark(words), host);
    LoopReport {
        released: report.released && released.is_over(),
        ..report
    }
}

/// Waits until the plant confirms the release of its controls, if they were taken.
pub(super) fn release_by(
    authority: Option<&Arc<dyn ControlAuthority>>,
    say: &mut dyn FnMut(String),
    host: &mut dyn Host,
) -> Released {
    let held = authority.and_then(|authority| authority.held().map(|plant| (authority, plant)));
    let released = held.map_or(Released::Confirmed, |(authority, plant)| {
        let released = authority.release(&plant, GIVE_BACK_WITHIN, &mut || false);
        let is_over = released.is_ok_and(Released::is_over);
        let continues = if is_over { "" } else { host.continue_release() };
        say(match released {
            Ok(Released::Confirmed) => format!("{plant} confirmed the release of its controls"),
            Ok(Released::Unreachable) => {
                format!("{plant} has ended, and nothing holds its controls")
            }
            Ok(Released::Refused) => format!(
                "{plant} did not confirm the release of its controls: its machine, or a firewall \
                 there, reports that no program has that port; if the simulator still runs, its \
                 controls are held{continues}"
            ),
            Ok(Released::Unconfirmed | Released::Cancelled) => {
                format!("{plant} did not confirm the release of its controls{continues}")
            }
            Err(fault) => {
                let why = match fault {
                    ActuatorFault::Io { errno } => io::Error::from_raw_os_error(errno).to_string(),
                    other => other.to_string(),
                };
                format!(
                    "{plant} could not be asked ({why}) to confirm the release of its \
                     controls{continues}"
                )
            }
        });
        released.unwrap_or(Released::Unconfirmed)
    });
    host.end(released);
    released
}
