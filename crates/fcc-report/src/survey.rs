//! One pass over a recording, in memory that does not grow with it.

use std::path::Path;
use std::time::Duration;

use fcc_core::framework::{
    EventKind, EventOf, Message, MessageOf, Readings, RecordOf, State, Tick, Time,
};
use fcc_timer::{TimerError, TimingStats};

use super::box_plot::BoxPlot;
use super::continuity::{Continuity, Follows};
use super::csv::CsvFolder;
use super::durations::Durations;
use super::events::Events;
use super::findings::findings;
use super::log_histogram::log_histogram;
use super::origin::{FileEnd, Origin};
use super::plots::{Curve, Moment, Panel, Plot, Quantities};
use super::report::{Report, RunReport, Timing};
use super::reported::{Addition, Reported};
use super::states::States;
use super::thesis::ThesisFigures;
use fcc_record::{Damage, Item, Recording, Remark};
use fcc_telemetry::schema::Leaves;
use fcc_telemetry::{TimingReport, expiry_of};

/// Takes the messages of a recording in their order, and keeps the data of a
/// report.
pub struct Survey<C: Reported> {
    origin: Origin,
    addition: C::Addition,
    /// Deadline of the first tick: the zero of all times in the report.
    began_ns: Option<i64>,
    timing: Option<TimingStats>,
    page_faults: u64,
    continuity: Continuity,
    durations: Durations,
    states: States,
    events: Events,
    damages: Vec<Damage>,
    failsafes: u64,
    /// The last tick that an event says was not recorded.
    not_recorded_to: u64,
    plots: Vec<Plot>,
    lateness: Curve,
    values: Leaves,
    last_s: f64,
}

/// Messages between two reports of progress.
const PROGRESS_EVERY: u64 = 4_096;

impl<C: Reported> Survey<C> {
    /// A survey of a recording from `origin`.
    pub fn new(origin: Origin, addition: C::Addition) -> Self {
        Self {
            origin,
            addition,
            began_ns: None,
            timing: None,
            page_faults: 0,
            continuity: Continuity::default(),
            durations: Durations::default(),
            states: States::default(),
            events: Events::default(),
            damages: Vec::new(),
            failsafes: 0,
            not_recorded_to: 0,
            plots: C::plots(&Quantities::of::<RecordOf<C>>()),
            lateness: Curve::default(),
            values: Leaves::default(),
            last_s: 0.0,
        }
    }

    /// Reads a recording once, and reports on it. With a folder `csv`, writes
    /// each tick and event into tables there. `progress` receives the number of
    /// bytes read.
    ///
    /// # Errors
    /// When the file cannot be read or a table cannot be written.
    pub fn read(
        recording: &Recording,
        addition: C::Addition,
        csv: Option<&Path>,
        mut progress: impl FnMut(u64),
    ) -> Result<Report<C::Addition>, String> {
        let origin = Origin::of(recording);
        let folder = csv.unwrap_or(Path::new(""));
        let not_written =
            |error: std::io::Error| format!("{}: cannot be written: {error}", folder.display());
        let mut tables = csv
            .map(|folder| CsvFolder::<C>::create(folder, &origin, recording.path()))
            .transpose()
            .map_err(not_written)?;
        let mut survey = Self::new(origin, addition);
        let mut items = recording.items().map_err(|error| error.to_string())?;
        let mut count = 0_u64;
        while let Some(item) = items.next() {
            survey
                .take_item(&item)
                .map_err(|error| format!("{}: {error}", recording.path().display()))?;
            if let Some(tables) = &mut tables {
                match &item {
                    Item::Message(message) => tables.take(message),
                    Item::Remark(remark) => tables.take_remark(remark),
                    Item::Damage(damage) => tables.take_remark(&damage.remark()),
                    Item::Document(_) => Ok(()),
                }
                .map_err(not_written)?;
            }
            count += 1;
            if count.is_multiple_of(PROGRESS_EVERY) {
                progress(items.bytes_read());
            }
        }
        if let Some(tables) = tables {
            tables.finish().map_err(not_written)?;
        }
        Ok(survey.finish(FileEnd::of(recording, items.cut())))
    }

    /// Takes a message.
    ///
    /// # Errors
    /// When the rate is beyond the range of a loop: the file is not a
    /// recording.
    pub fn take(&mut self, message: &MessageOf<C>) -> Result<(), TimerError> {
        match message {
            Message::Tick(record) => self.take_record(record),
            Message::Event(event) => {
                self.take_event(event);
                Ok(())
            }
        }
    }

    fn take_record(&mut self, record: &RecordOf<C>) -> Result<(), TimerError> {
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
        let panels = self.plots.iter_mut().flat_map(|plot| &mut plot.panels);
        self.values.take(record);
        let moment = Moment::of(record, time_s);
        let is_after_gap = follows == Follows::AfterGap;
        for panel in panels {
            if is_after_gap {
                panel.cut();
            }
            panel.take(self.values.as_slice(), &moment);
        }
        if is_after_gap {
            timing.interrupt();
            self.lateness.trace.cut();
        }
        let lateness_us = tick.lateness().as_secs_f64() * 1e6;
        self.lateness.trace.push(time_s, Some(lateness_us));
        timing.record(&expiry_of(record));
        self.page_faults = self.page_faults.max(record.page_faults);
        self.durations.record(record);
        self.states.take(time_s, record.state.state());
        C::take(&mut self.addition, record, time_s);
        Ok(())
    }

    /// Takes an item of a recording.
    ///
    /// # Errors
    /// As for [`take`](Self::take).
    pub fn take_item(&mut self, item: &Item<MessageOf<C>>) -> Result<(), TimerError> {
        let tick = self.continuity.last_tick;
        match item {
            Item::Message(message) => self.take(message)?,
            Item::Remark(Remark { time, text }) => {
                self.events.remark(self.seconds(*time), tick, text);
            }
            // The lines are interrupted: ticks are missing.
            Item::Damage(damage) => {
                let remark = damage.remark();
                let time_s = self.seconds(remark.time);
                self.events.damage(time_s, tick, &remark.text);
                self.damages.push(damage.clone());
            }
            Item::Document(_) => {}
        }
        Ok(())
    }

    /// Time of an event; 0 for an event before or in the first tick.
    fn seconds(&self, time: Time) -> f64 {
        match self.began_ns {
            Some(began_ns) if !time.is_never() => since(began_ns, time.as_nanos()).max(0.0),
            _ => 0.0,
        }
    }

    fn take_event(&mut self, event: &EventOf<C>) {
        if let EventKind::StateChanged {
            to: State::Failsafe(_),
            ..
        } = event.kind
        {
            self.failsafes += 1;
        }
        if let EventKind::NotRecorded { last, .. } = event.kind {
            self.not_recorded_to = self.not_recorded_to.max(last);
        }
        let time_s = self.seconds(event.time);
        self.events.take::<C>(time_s, event, &self.origin);
        C::take_event(&mut self.addition, event);
    }

    /// The report, once the file has ended.
    pub fn finish(mut self, end: FileEnd) -> Report<C::Addition> {
        let (events, event_count) = self.events.into_lines();
        let timing = self
            .timing
            .map(|stats| timing(&stats, self.page_faults, &self.origin));
        self.addition.finish();
        let last_tick = self.continuity.last_tick;
        self.continuity.lost_after = self.not_recorded_to.saturating_sub(last_tick);
        let panels = self.plots.iter().flat_map(|plot| &plot.panels);
        let values = panels
            .filter(|_| C::TABLE_OF_VALUES)
            .flat_map(Panel::ranges);
        let mut run = RunReport {
            origin: self.origin,
            end,
            damages: self.damages,
            duration_s: self.last_s,
            findings: Vec::new(),
            continuity: self.continuity,
            timing,
            stages: self.durations.stages(),
            sensor_ages: self.durations.ages(C::Measurements::NAMES),
            states: self.states.into_spans(),
            failsafes: self.failsafes,
            events,
            event_count,
            values: values.collect(),
            terms: C::TERMS,
            plots: self.plots,
            lateness: self.lateness,
        };
        run.findings = findings(&run);
        if run.continuity.ticks > 0 {
            run.findings.extend(self.addition.findings());
        }
        Report {
            run,
            addition: self.addition,
        }
    }
}

/// Seconds from one time of the loop to another.
fn since(began_ns: i64, nanos: i64) -> f64 {
    nanos.saturating_sub(began_ns) as f64 / 1e9
}

/// The loop's period, from one tick.
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
