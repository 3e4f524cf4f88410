//! What [`Observer`] promises, as a test that every implementation runs: for
//! tests only, behind the feature `conformance`.
#![allow(
    clippy::missing_panics_doc,
    clippy::expect_used,
    clippy::panic,
    reason = "every function here is a test: it panics when the promise is broken"
)]

use std::sync::Arc;
use std::time::Duration;

use fcc_core::framework::{
    ActuatorFault, Cause, Event, EventKind, Flags, LoopCommand, Reading, Record, RecordOf,
    SensorFault, State, Tick, Time,
};
use fcc_fixed_wing::{Autopilot, AutopilotConfig};
use fcc_record::RecorderStatus;
use fcc_runtime::{Link, LoopConfig, Machine, Parts};
use fcc_timer::{ManualTimer, RealtimeGranted};

use super::observer::{Access, Facts, FlightTime, Observer, Report, Reports};
use super::outcome::{Conclusion, Outcome};
use super::pilot::Pilot;
use super::plan::Pace;

/// Takes an observer through every flight that the trait allows; `new` makes
/// one for each. It may not panic, give a command that nobody gave it, report
/// again what has not changed, or change what is not its own in the outcome.
pub fn observer_conforms(new: impl Fn() -> Box<dyn Observer<Autopilot>>) {
    for pace in [Pace::RealTime, Pace::Lockstep] {
        let mut flight = Flight::of(new());
        flight.prepare();
        flight.begin(pace);
        flight.happens();
        flight.goes_wrong();
        flight.nothing_new();
        flight.observer.stopping();
        flight.end();
    }
    Flight::of(new()).end();

    let mut never_began = Flight::of(new());
    never_began.prepare();
    never_began.reports();
    never_began.end();

    // A flight of which nobody reported the beginning.
    let mut late = Flight::of(new());
    late.happens();
    late.goes_wrong();
    late.end();

    let mut without_a_tick = Flight::of(new());
    without_a_tick.prepare();
    without_a_tick.begin(Pace::RealTime);
    without_a_tick.nothing_new();
    without_a_tick.end();
}

/// An observer, and a loop that it observes.
struct Flight {
    observer: Box<dyn Observer<Autopilot>>,
    machine: Machine<Pilot>,
    link: Link<Pilot>,
    reports: Reports,
}

impl Flight {
    fn of(observer: Box<dyn Observer<Autopilot>>) -> Self {
        let timer = ManualTimer::new(Duration::from_millis(25)).expect("a period");
        let parts = Parts {
            timer: Box::new(timer),
            sensors: Vec::new(),
            controller: Pilot::new(Autopilot::new(AutopilotConfig::default()), None),
            actuators: Vec::new(),
        };
        let (machine, link) = Machine::new(parts, &LoopConfig::default()).expect("a loop");
        Self {
            observer,
            machine,
            link,
            reports: Reports::default(),
        }
    }

    fn prepare(&mut self) {
        self.observer.prepare(&mut self.reports);
        self.poll();
    }

    fn begin(&mut self, pace: Pace) {
        let granted = RealtimeGranted::default();
        let facts = Facts {
            rate_hz: 40.0,
            timer: "manual",
            sensors: &["air data".to_owned()],
            actuators: &["surfaces".to_owned()],
            started_unix_ns: 1_700_000_000_000_000_000,
            clock_offset_ns: 1_700_000_000_000_000_000,
            pace,
            granted: (pace == Pace::RealTime).then_some(&granted),
        };
        self.observer.begin(&facts, &mut self.reports);
        self.poll();
    }

    /// An ordinary flight: standby, engaged, failsafe, stopped.
    fn happens(&mut self) {
        let states = [
            State::Standby,
            State::Engaged,
            State::Failsafe(Cause::Faults(Flags::NONE)),
            State::Stopped,
        ];
        let mut at = FlightTime::default();
        for (round, state) in (0_u64..).zip(states) {
            for tick in 0..50 {
                let record = record(round * 50 + tick, state);
                at = FlightTime {
                    time_s: record.tick.number as f64 * 0.025,
                    tick: record.tick.number,
                    woke_ns: record.tick.woke.as_nanos(),
                    engaged_at_s: (state == State::Engaged).then_some(1.25),
                };
                self.observer.record(&record, &at);
            }
            for event in events(at.tick) {
                self.observer.event(&event, "it happened", &at);
            }
            self.reports();
            self.poll();
        }
    }

    /// What no healthy loop reports: ticks that are missing or come again,
    /// numbers that are none, events of no time.
    fn goes_wrong(&mut self) {
        let mut record: RecordOf<Autopilot> = record(u64::MAX, State::Engaged);
        record.measurements.altitude_m = Reading::new(f64::NAN, Time::from_nanos(i64::MAX));
        record.outputs.elevator = f64::INFINITY;
        record.setpoints.heading_rad = f64::NAN;
        let at = FlightTime {
            time_s: f64::MAX,
            tick: u64::MAX,
            woke_ns: i64::MAX,
            engaged_at_s: Some(-1.0),
        };
        self.observer.record(&record, &at);
        self.observer
            .record(&Record::default(), &FlightTime::default());
        let long = "ä".repeat(10_000);
        for event in events(0) {
            self.observer.event(&event, &long, &FlightTime::default());
        }
        self.observer.report(&Report::Remark(long), &at);
        self.poll();
    }

    fn reports(&mut self) {
        for report in [
            Report::Remark("a remark".to_owned()),
            Report::Mention("a mention".to_owned()),
            Report::Recording(RecorderStatus::default()),
            Report::Plan(Arc::default()),
        ] {
            self.observer.report(&report, &FlightTime::default());
        }
    }

    /// Lets it act. Nobody has given a command, so none may reach the loop.
    fn poll(&mut self) {
        let room = self.link.commands.room();
        self.observer.poll(&mut Access {
            commands: &mut self.link.commands,
            reports: &mut self.reports,
            before_control: &mut || panic!("takes control though nobody asked it to"),
        });
        assert_eq!(
            self.link.commands.room(),
            room,
            "gives a command of its own"
        );
    }

    /// While nothing happens nothing is reported twice. An observer's own
    /// thread may report late.
    fn nothing_new(&mut self) {
        self.reports.take();
        let mut said = Vec::new();
        for _ in 0..20 {
            self.poll();
            for report in self.reports.take() {
                match report {
                    Report::Remark(words) | Report::Mention(words) => said.push(words),
                    Report::Recording(_) | Report::Plan(_) => {}
                }
            }
        }
        let mut different = said.clone();
        different.sort();
        different.dedup();
        assert_eq!(said.len(), different.len(), "reported again: {said:?}");
    }

    fn end(mut self) {
        let mut outcome = Outcome::new("manual", Pace::Lockstep, &self.machine.finish());
        let before = outcome.conclusion;
        let own = |outcome: &Outcome| (outcome.ending.clone(), outcome.released, outcome.overruns);
        let of_the_loop = own(&outcome);
        self.observer
            .end("stop requested", &mut outcome, &mut self.reports);
        assert_eq!(own(&outcome), of_the_loop, "changes what is not its own");
        // A recorder says that not all was recorded.
        assert!([before, Conclusion::NotRecorded].contains(&outcome.conclusion));
    }
}

fn record<M: Default, E: Default, S: Default, O: Default>(
    number: u64,
    state: State,
) -> Record<M, E, S, O> {
    let time = Time::from_nanos(number.min(1 << 32) as i64 * 25_000_000);
    let tick = Tick {
        number,
        scheduled: time,
        woke: time,
        ..Tick::default()
    };
    Record::new(tick, state)
}

fn events<R: Copy>(tick: u64) -> Vec<Event<R>> {
    let state_changed = EventKind::StateChanged {
        from: State::Standby,
        to: State::Engaged,
    };
    [
        state_changed,
        EventKind::CommandReceived(LoopCommand::Disengage),
        EventKind::StopRequested,
        EventKind::EngageRefused {
            engage_inhibits: Flags::NONE,
        },
        EventKind::SensorFault {
            index: 7,
            fault: SensorFault::Silent,
        },
        EventKind::SensorRecovered { index: 7 },
        EventKind::ActuatorFault {
            index: 7,
            fault: ActuatorFault::Unconfirmed,
        },
        EventKind::ActuatorRecovered { index: 7 },
        EventKind::Released { ok: true },
        EventKind::Panicked,
        EventKind::TimerFailed,
        EventKind::Hung { silent_ns: 1 },
        EventKind::Overloaded {
            used_ns: 12,
            period_ns: 10,
        },
        EventKind::OverloadOver {
            count: 3,
            first: 1,
            last: 3,
        },
        EventKind::StoppedByOverload,
    ]
    .map(|kind| Event {
        tick,
        time: Time::NEVER,
        kind,
    })
    .into()
}
