//! One pass over a recording, in memory that does not grow with it.

use std::time::Duration;

use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_core::framework::{Message, Tick};
use fcc_timer::{Expiry, TimerError, TimingStats};

use super::box_plot::BoxPlot;
use super::continuity::{Continuity, Follows};
use super::durations::Durations;
use super::events::{self, Events};
use super::findings::findings;
use super::lines::Lines;
use super::log_histogram::log_histogram;
use super::origin::{FileEnd, Origin};
use super::scoring::Scoring;
use super::states::States;
use super::thesis::ThesisFigures;
use super::track::Track;
use super::{Report, Timing};
use crate::{FlightEvent, FlightMessage, FlightRecord, TimingReport};

/// Takes the messages of a flight in the order they were recorded, and keeps
/// what a report shows.
#[derive(Debug)]
pub struct Survey {
    origin: Origin,
    scoring: Option<Scoring>,
    /// The loop's time that the report counts from.
    began_ns: Option<i64>,
    timing: Option<TimingStats>,
    continuity: Continuity,
    durations: Durations,
    states: States,
    events: Events,
    failsafes: u64,
    lines: Lines,
    track: Track,
    last_s: f64,
}

impl Survey {
    /// A survey of a flight from `origin`, scored if it is to be along a
    /// timed pattern.
    pub fn new(origin: Origin, pattern: Option<TimedPatternConfig>) -> Self {
        Self {
            origin,
            scoring: pattern.map(Scoring::new),
            began_ns: None,
            timing: None,
            continuity: Continuity::default(),
            durations: Durations::default(),
            states: States::default(),
            events: Events::default(),
            failsafes: 0,
            lines: Lines::default(),
            track: Track::default(),
            last_s: 0.0,
        }
    }

    /// Takes a message.
    ///
    /// # Errors
    /// When the rate is beyond what a loop can have: the file is no recording
    /// of one.
    pub fn take(&mut self, message: &FlightMessage) -> Result<(), TimerError> {
        match message {
            Message::Tick(record) => self.take_record(record),
            Message::Event(event) => {
                self.take_event(event);
                Ok(())
            }
        }
    }

    /// Takes the record of a tick.
    ///
    /// # Errors
    /// As for [`take`](Self::take).
    pub fn take_record(&mut self, record: &FlightRecord) -> Result<(), TimerError> {
        let tick = &record.tick;
        let time_s = self.seconds(tick.scheduled.as_nanos());
        match self.continuity.take(tick, time_s) {
            Follows::Directly => {}
            Follows::AfterGap => self.lines.cut(),
            Follows::Not => return Ok(()),
        }
        self.last_s = time_s;
        let timing = match &mut self.timing {
            Some(timing) => timing,
            None => self.timing.insert(TimingStats::new(period(tick))?),
        };
        timing.record(&Expiry {
            number: tick.number,
            scheduled_ns: tick.scheduled.as_nanos(),
            woke_ns: tick.woke.as_nanos(),
            missed: tick.missed,
        });
        self.durations.record(record);
        self.states.take(time_s, record.state.state());
        self.lines.take(record, time_s);
        let position = &record.measurements.position;
        if !position.is_never() {
            self.track.push(time_s, &position.value);
        }
        if let Some(scoring) = &mut self.scoring {
            scoring.take(record, time_s);
        }
        Ok(())
    }

    /// Takes an event.
    pub fn take_event(&mut self, event: &FlightEvent) {
        let time_s = if event.time.is_never() {
            0.0
        } else {
            self.seconds(event.time.as_nanos()).max(0.0)
        };
        if events::is_order_to_autopilot(event.kind)
            && let Some(scoring) = &mut self.scoring
        {
            scoring.ordered();
        }
        self.failsafes += u64::from(events::is_failsafe(event.kind));
        self.events.take(time_s, event, &self.origin);
    }

    /// The report, once the file has ended.
    pub fn finish(self, end: FileEnd) -> Report {
        let (events, event_count) = self.events.into_lines();
        let (flight, not_scored) = match self.scoring {
            Some(scoring) => {
                let (score, failed) = scoring.finish();
                (Some(score).filter(|score| !score.legs.is_empty()), failed)
            }
            None => (None, None),
        };
        let timing = self.timing.map(|stats| timing(&stats, &self.origin));
        let mut report = Report {
            origin: self.origin,
            end,
            duration_s: self.last_s,
            findings: Vec::new(),
            continuity: self.continuity,
            timing,
            stages: self.durations.stages(),
            sensor_ages: self.durations.ages(),
            states: self.states.into_spans(),
            failsafes: self.failsafes,
            events,
            event_count,
            flight,
            not_scored,
            lines: self.lines,
            track: self.track.into_places(),
        };
        report.findings = findings(&report);
        report
    }

    /// Since the first time that was seen.
    fn seconds(&mut self, nanos: i64) -> f64 {
        let began_ns = *self.began_ns.get_or_insert(nanos);
        nanos.saturating_sub(began_ns) as f64 * 1e-9
    }
}

/// The loop's period, from what one tick says of it.
fn period(tick: &Tick) -> Duration {
    let period_s = tick.dt_s / (tick.missed.saturating_add(1)) as f64;
    Duration::try_from_secs_f64(period_s).unwrap_or_default()
}

fn timing(stats: &TimingStats, origin: &Origin) -> Timing {
    let summary = stats.summary();
    let periods: Vec<_> = stats.period_counts().collect();
    Timing {
        table: TimingReport::new(&origin.timer, &summary, origin.realtime.clone()),
        period_box_ms: BoxPlot::of(&periods),
        lateness_histogram: log_histogram(stats.lateness_counts()),
        thesis: ThesisFigures::at(summary.rate_hz),
    }
}
