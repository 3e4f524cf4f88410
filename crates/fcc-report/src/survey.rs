//! One pass over a recording, in memory that does not grow with it.

use std::time::Duration;

use fcc_core::flight::guidance::TimedPatternConfig;
use fcc_core::framework::{Message, Tick, Time};
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
use fcc_record::{Damage, Item, Remark};
use fcc_telemetry::{FlightEvent, FlightMessage, FlightRecord, TimingReport};

/// Takes the messages of a flight in the order they were recorded, and keeps
/// what a report shows.
#[derive(Debug)]
pub struct Survey {
    origin: Origin,
    scoring: Option<Scoring>,
    /// When the first tick was due: the report counts from there.
    began_ns: Option<i64>,
    timing: Option<TimingStats>,
    page_faults: u64,
    continuity: Continuity,
    durations: Durations,
    states: States,
    events: Events,
    damages: Vec<Damage>,
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
            page_faults: 0,
            continuity: Continuity::default(),
            durations: Durations::default(),
            states: States::default(),
            events: Events::default(),
            damages: Vec::new(),
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
        let scheduled_ns = tick.scheduled.as_nanos();
        let began_ns = *self.began_ns.get_or_insert(scheduled_ns);
        let time_s = since(began_ns, scheduled_ns);
        let follows = self.continuity.take(tick, time_s);
        if follows == Follows::Not {
            return Ok(());
        }
        self.last_s = time_s;
        let timing = match &mut self.timing {
            Some(timing) => timing,
            None => self.timing.insert(TimingStats::new(period(tick))?),
        };
        if follows == Follows::AfterGap {
            timing.interrupt();
            self.lines.cut();
        }
        timing.record(&Expiry {
            number: tick.number,
            scheduled_ns: tick.scheduled.as_nanos(),
            woke_ns: tick.woke.as_nanos(),
            missed: tick.missed,
            early_wake_ns: record.early_wake_ns,
            ..Expiry::default()
        });
        self.page_faults = self.page_faults.max(record.page_faults);
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

    /// Takes whatever is in a recording.
    ///
    /// # Errors
    /// As for [`take`](Self::take).
    pub fn take_item(&mut self, item: &Item<FlightMessage>) -> Result<(), TimerError> {
        match item {
            Item::Message(message) => self.take(message)?,
            Item::Remark(remark) => self.take_remark(remark),
            Item::Damage(damage) => self.take_damage(damage),
        }
        Ok(())
    }

    /// Takes what is damaged in the recording: no line leads across.
    pub fn take_damage(&mut self, damage: &Damage) {
        let remark = damage.remark();
        let time_s = self.seconds(remark.time);
        self.events
            .damage(time_s, self.continuity.last_tick, &remark.text);
        self.damages.push(damage.clone());
    }

    /// Takes words that are no event of the loop.
    pub fn take_remark(&mut self, remark: &Remark) {
        let time_s = self.seconds(remark.time);
        let tick = self.continuity.last_tick;
        self.events.remark(time_s, tick, &remark.text);
    }

    /// When something happened; before the first tick, or in it, is at 0.
    fn seconds(&self, time: Time) -> f64 {
        match self.began_ns {
            Some(began_ns) if !time.is_never() => since(began_ns, time.as_nanos()).max(0.0),
            _ => 0.0,
        }
    }

    /// Takes an event.
    pub fn take_event(&mut self, event: &FlightEvent) {
        let time_s = self.seconds(event.time);
        if events::is_autopilot_command(event.kind)
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
        let timing = self
            .timing
            .map(|stats| timing(&stats, self.page_faults, &self.origin));
        let mut report = Report {
            origin: self.origin,
            end,
            damages: self.damages,
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
}

/// Seconds from one time of the loop to another.
fn since(began_ns: i64, nanos: i64) -> f64 {
    nanos.saturating_sub(began_ns) as f64 / 1e9
}

/// The loop's period, from what one tick says of it.
fn period(tick: &Tick) -> Duration {
    let period_s = tick.dt_s / (tick.missed.saturating_add(1)) as f64;
    Duration::try_from_secs_f64(period_s).unwrap_or_default()
}

fn timing(stats: &TimingStats, page_faults: u64, origin: &Origin) -> Timing {
    let summary = stats.summary();
    let periods: Vec<_> = stats.period_counts().collect();
    Timing {
        table: TimingReport {
            page_faults: Some(page_faults),
            ..TimingReport::new(&origin.timer, &summary, origin.realtime.clone())
        },
        period_box_ms: BoxPlot::of(&periods),
        lateness_histogram: log_histogram(stats.lateness_counts()),
        thesis: ThesisFigures::at(summary.rate_hz),
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Flags, StateCode};
    use proptest::prelude::*;

    use super::*;

    /// A record of anything at all: a damaged file can hold it.
    fn record() -> impl Strategy<Value = FlightRecord> {
        let numbers = || prop::array::uniform8(any::<f64>());
        let times = (any::<i64>(), any::<i64>(), any::<i64>());
        let missed = prop_oneof![0_u64..5, any::<u64>()];
        let counts = (0_u64..50, missed, any::<u64>(), 0_u8..4);
        (times, counts, numbers(), numbers()).prop_map(
            |((due, woke, taken), (step, missed, stage_ns, phase), a, b)| {
                let tick = Tick {
                    number: step,
                    scheduled: Time::from_nanos(due),
                    woke: Time::from_nanos(woke),
                    missed,
                    dt_s: 0.025,
                };
                let mut record = FlightRecord {
                    tick,
                    ..FlightRecord::default()
                };
                record.stages.total_ns = stage_ns;
                record.state = StateCode::from_parts(phase, u8::from(phase == 2), Flags::NONE)
                    .unwrap_or_default();
                record.sent = stage_ns % 2 == 0;
                let taken = Time::from_nanos(taken);
                let measured = &mut record.measurements;
                let [
                    roll,
                    pitch,
                    heading,
                    airspeed,
                    altitude,
                    latitude,
                    longitude,
                    side,
                ] = a;
                measured.attitude.value.roll_rad = roll;
                measured.attitude.value.pitch_rad = pitch;
                measured.heading_rad.value = heading;
                measured.airspeed_mps.value = airspeed;
                measured.altitude_m.value = altitude;
                measured.position.value.latitude_rad = latitude;
                measured.position.value.longitude_rad = longitude;
                measured.specific_force.value.y_mps2 = side;
                measured.attitude.taken = taken;
                measured.heading_rad.taken = record.tick.woke;
                measured.airspeed_mps.taken = record.tick.woke;
                measured.altitude_m.taken = taken;
                measured.position.taken = taken;
                let [
                    throttle,
                    elevator,
                    aileron,
                    rudder,
                    speed,
                    aimed,
                    height,
                    bank,
                ] = b;
                record.outputs.throttle = throttle;
                record.outputs.elevator = elevator;
                record.outputs.aileron = aileron;
                record.outputs.rudder = rudder;
                record.setpoints.airspeed_mps = speed;
                record.setpoints.heading_rad = aimed;
                record.setpoints.altitude_m = height;
                record.setpoints.roll_rad = bank;
                record
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Nothing that a file can hold makes a report panic or grow.
        #[test]
        fn anything_can_be_reported_on(
            records in prop::collection::vec(record(), 0..40),
            in_order in any::<bool>(),
        ) {
            let pattern = TimedPatternConfig::default();
            let mut survey = Survey::new(Origin::default(), Some(pattern));
            let mut number = 0;
            let mut due_ns = 0_i64;
            for (n, mut record) in records.into_iter().enumerate() {
                if n == 0 {
                    // The first says how long a period is; a loop cannot have any.
                    record.tick.missed %= 5;
                }
                if in_order {
                    number += record.tick.number;
                    due_ns = due_ns.saturating_add(record.tick.scheduled.as_nanos().abs() >> 20);
                    record.tick.number = number;
                    record.tick.scheduled = Time::from_nanos(due_ns);
                }
                survey.take_record(&record).unwrap();
            }
            let report = survey.finish(FileEnd::Unknown);
            let page = report.to_html().unwrap();
            prop_assert!(page.len() < 5_000_000);
            prop_assert!(!report.to_text().is_empty());
            prop_assert!(serde_json::to_string(&report).is_ok());
        }
    }
}
