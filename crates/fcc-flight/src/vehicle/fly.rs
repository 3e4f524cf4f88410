//! Flies a vehicle to its end.

use std::thread;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use fcc_core::framework::{AfterRelease, LoopCommand, Message, State};
use fcc_runtime::{
    Ending, Link, Loop, LoopConfig, LoopReport, Machine, Parts, StopHandle, WatchdogConfig,
};
use fcc_sim::TruthHandle;
use fcc_timer::{ManualTimer, RealtimeRequest, Timer};

use super::{Sections, Vehicle};
use crate::config::WatchdogSection;
use crate::flight::event_log::EventLog;
use crate::flight::hang::HangWatch;
use crate::flight::observer_list::{Names, ObserverList};
use crate::flight::recording::{FlightRecorder, RecordingRequest, about_of};
use crate::flight::run_statistics::RunStatistics;
use crate::flight::{Facts, FlyError, Host, Impact, Observer, Outcome, Pace};

/// How often the loop's messages are read.
const FETCH_EVERY: Duration = Duration::from_millis(10);
/// How long a failsafe holds control after the vehicle has come to rest.
const HOLD: Duration = Duration::from_secs(1);
/// No flight takes longer, s.
const LONGEST_S: f64 = 3_600.0;

/// The loop's configuration. Nobody else could control such a vehicle: a failsafe lasts until it
/// rests, and ends the flight.
pub(super) fn loop_config(sections: &Sections<'_>) -> LoopConfig {
    let most = LoopConfig::default().messages_capacity;
    LoopConfig {
        messages_capacity: sections.tick.ticks_in(8.0, most),
        failsafe_hold: HOLD,
        after_failsafe: AfterRelease::Stop,
        early_wake_needs_priority: true,
        realtime: RealtimeRequest::from(sections.realtime),
        ..LoopConfig::default()
    }
}

/// Flies until the vehicle rests after it has moved, for so many seconds after the first
/// engagement, or until the host stops it; then it is brought to rest.
///
/// # Errors
/// When the flight does not begin; what happens later is in the outcome.
pub fn fly_vehicle<V: Vehicle>(
    config: &V::Config,
    as_given: Option<String>,
    (pace, seconds): (Pace, Option<f64>),
    observers: Vec<Box<dyn Observer<V>>>,
    host: &mut dyn Host,
) -> Result<Outcome, FlyError> {
    let sections = V::sections(config);
    let loop_config = loop_config(&sections);
    let unopened = |why: String| FlyError::Host(std::io::Error::other(why));
    let ends_at_rest = V::ends_at_rest(config);
    let commanders = match pace {
        Pace::RealTime => V::commanders(config).map_err(unopened)?,
        Pace::Lockstep if ends_at_rest => Vec::new(),
        Pace::Lockstep => {
            return Err(unopened(
                "others command this flight, in real time: fly it without --lockstep".to_owned(),
            ));
        }
    };
    let opened = V::open(config).map_err(unopened)?;
    host.prepare(None).map_err(FlyError::Host)?;
    let timer: Box<dyn Timer> = match pace {
        Pace::RealTime => sections.tick.build_timer()?,
        Pace::Lockstep => Box::new(ManualTimer::new(sections.tick.period())?),
    };
    let timer_name = timer.name();
    let names = Names::of(&opened.sensors, &opened.actuators);
    let about = about_of(V::NAME, sections.tick.rate_hz, config, as_given);
    let mut all: Vec<Box<dyn Observer<V>>> = Vec::new();
    if let Some(request) = RecordingRequest::new(sections.recording, sections.tick, about) {
        all.push(Box::new(FlightRecorder::<V>::new(request)));
    }
    all.push(V::scorer(opened.truth));
    all.extend(commanders);
    all.extend(observers);
    // The last, so that it receives what the others report at their end.
    all.push(Box::new(EventLog::default()));
    let mut list = ObserverList::new(all, names.clone());
    list.prepare();
    let started_unix_ns = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_nanos() as u64);
    let facts = Facts {
        rate_hz: sections.tick.rate_hz,
        timer: timer_name,
        sensors: &names.sensors,
        actuators: &names.actuators,
        started_unix_ns,
        clock_offset_ns: (started_unix_ns as i64).saturating_sub(timer.now_ns()),
        pace,
        granted: None,
    };
    let parts = Parts {
        timer,
        sensors: opened.sensors,
        controller: V::controller(config).map_err(unopened)?,
        actuators: opened.actuators,
    };
    let wish = StopHandle::default();
    host.attach(&wish).map_err(FlyError::Host)?;
    let flown = Flown {
        seconds: seconds.unwrap_or(LONGEST_S),
        wish,
        ..Flown::default()
    };
    let mut flight = Flight {
        list,
        host,
        true_now: opened.true_now,
        ends_at_rest,
        flown,
    };
    let report = match pace {
        Pace::RealTime => flight.in_real_time(parts, &loop_config, facts)?,
        Pace::Lockstep => {
            let (machine, mut link) = Machine::new(parts, &loop_config)?;
            flight.list.begin(&facts);
            flight.host.started();
            flight.in_lockstep(machine, &mut link)?
        }
    };
    let interrupted_by = flight.host.interrupted_by();
    let mut outcome = Outcome::new(timer_name, pace, &report);
    outcome.interrupted = interrupted_by.is_some();
    if let Some(impact) = flight.flown.impact {
        outcome.hit_ground(impact);
    } else if let Some(by) = interrupted_by {
        outcome.ending = format!("interrupted by {by}");
    } else if flight.flown.is_over && matches!(report.ending, Ending::StopFlag) {
        "it has landed".clone_into(&mut outcome.ending);
    }
    let ending = outcome.ending.clone();
    flight.list.end(&ending, &mut outcome);
    Ok(outcome)
}

/// What is known of the flight so far.
#[derive(Default)]
struct Flown {
    seconds: f64,
    /// The host stops the flight.
    wish: StopHandle,
    has_moved: bool,
    is_over: bool,
    engaged_since_s: Option<f64>,
    /// Whether a descent was commanded.
    ends: bool,
    impact: Option<Impact>,
}

struct Flight<'a, V: Vehicle> {
    list: ObserverList<V>,
    host: &'a mut dyn Host,
    true_now: TruthHandle,
    ends_at_rest: bool,
    flown: Flown,
}

impl<V: Vehicle> Flight<'_, V> {
    /// Reads all messages, and ends the flight when it is over.
    fn drain(&mut self, link: &mut Link<V>, statistics: Option<&mut RunStatistics<V>>) {
        let mut statistics = statistics;
        while let Some(message) = link.messages.receive() {
            self.list.take(&message);
            if let Some(statistics) = &mut statistics {
                statistics.take(&message);
            }
            if let Message::Tick(record) = &message {
                let rests = V::rests(record);
                self.flown.has_moved |= !rests;
                let ends = self.ends_at_rest || self.flown.ends;
                self.flown.is_over |= ends && self.flown.has_moved && rests;
                if record.state == State::Engaged {
                    let now_s = self.list.monitor.at().time_s;
                    self.flown.engaged_since_s.get_or_insert(now_s);
                }
            }
        }
        if self.flown.impact.is_none()
            && let Some(truth) = self.true_now.impact()
        {
            let impact = Impact::from(&truth);
            self.list.remark(impact.to_string());
            self.flown.impact = Some(impact);
        }
        let flown = &mut self.flown;
        if flown.is_over || flown.impact.is_some() {
            link.stop.stop();
        }
        let now_s = self.list.monitor.at().time_s;
        let is_up = flown
            .engaged_since_s
            .is_some_and(|since_s| now_s - since_s >= flown.seconds);
        if (flown.wish.is_set() || is_up || now_s > LONGEST_S) && !flown.ends {
            // A second stop would not wait for the ground.
            flown.ends = link.commands.send(LoopCommand::Stop).is_ok();
        }
        self.list.poll(&mut link.commands, self.host);
    }

    fn in_lockstep(
        &mut self,
        mut machine: Machine<V>,
        link: &mut Link<V>,
    ) -> Result<LoopReport, FlyError> {
        machine.start()?;
        while machine.step() != State::Stopped {
            self.drain(link, None);
        }
        let report = machine.finish();
        self.drain(link, None);
        Ok(report)
    }

    fn in_real_time(
        &mut self,
        parts: Parts<V>,
        loop_config: &LoopConfig,
        facts: Facts<'_>,
    ) -> Result<LoopReport, FlyError> {
        let period = parts.timer.period();
        let (flight_loop, mut link) = Loop::new(parts, loop_config)?;
        let watched = WatchdogConfig {
            hang_after: WatchdogSection::default().hang_after(period),
            loop_priority: loop_config.realtime.priority,
        };
        let (mut watchdog, _) =
            HangWatch::start(&watched, &link, None, self.host).map_err(FlyError::Watchdog)?;
        let mut statistics = RunStatistics::<V>::new(period)?;
        let handle = flight_loop.spawn()?;
        let granted = handle.granted().clone();
        for denied in &granted.denied {
            self.list.remark(denied.to_string());
        }
        self.list.begin(&Facts {
            granted: Some(&granted),
            ..facts
        });
        self.host.started();
        let mut hung = None;
        while hung.is_none() && !link.messages.is_over() {
            self.drain(&mut link, Some(&mut statistics));
            self.host.poll(&mut |words| self.list.remark(words));
            hung = watchdog.look(&link, &mut |words| self.list.remark(words));
            thread::sleep(FETCH_EVERY);
        }
        self.drain(&mut link, Some(&mut statistics));
        self.list.stopping();
        Ok(match hung {
            None => handle.join(),
            Some(hung) => {
                handle.abandon();
                statistics.report(hung, facts.timer, granted)
            }
        })
    }
}
