//! The recording of a flight.

use std::time::{Duration, Instant};

use fcc_core::framework::{EventOf, MessageOf, RecordOf};
use fcc_record::{About, Notice, Recorded, RecorderOf, RecorderSettings, RecordingPace};
use fcc_telemetry::Realtime;
use nix::sys::utsname::{UtsName, uname};
use serde::Serialize;

use super::observer::{Access, Facts, FlightTime, Observer, Report, Reports};
use super::outcome::{Outcome, RecordingOutcome};
use super::plan::Pace;
use crate::config::{Aircraft, Config, LoopSection, RecordingSection, keyed};

/// How long a disk may be delayed before records are lost, at 136 Hz or less.
const WRITTEN_WITHIN_S: f64 = 60.0;

/// A request to record a flight.
#[derive(Clone, Debug)]
pub struct RecordingRequest {
    settings: RecorderSettings,
    about: About,
}

impl RecordingRequest {
    /// The request for a configuration, if it enables recording; `as_given` is
    /// the text of its file.
    pub fn of(config: &Config, as_given: Option<String>) -> Option<Self> {
        let (section, tick) = (&config.recording, &config.tick);
        Self::new(section, tick, about(config, as_given))
    }

    /// The request for a section of a configuration, if it enables recording.
    pub(crate) fn new(
        section: &RecordingSection,
        tick: &LoopSection,
        about: About,
    ) -> Option<Self> {
        let settings = RecorderSettings::from(section);
        let capacity = tick.ticks_in(WRITTEN_WITHIN_S, settings.capacity);
        section.enabled.then_some(Self {
            settings: RecorderSettings {
                capacity,
                ..settings
            },
            about,
        })
    }
}

/// Facts about a flight from its configuration and its machine.
pub fn about(config: &Config, as_given: Option<String>) -> About {
    let plant = match config.aircraft() {
        Some(Aircraft::XPlane(_)) => "x-plane",
        Some(Aircraft::BuiltIn(_)) => "built-in",
        None => "none",
    };
    about_of(plant, config.tick.rate_hz, config, as_given)
}

/// The same for any vehicle's configuration.
pub(crate) fn about_of(
    plant: &str,
    rate_hz: f64,
    config: &impl Serialize,
    as_given: Option<String>,
) -> About {
    // A configuration that was read can be written.
    let values = toml::Value::try_from(config);
    let values = values.iter().flat_map(keyed);
    let parameter = |(key, value): (String, &toml::Value)| match value {
        toml::Value::Table(_) => None,
        toml::Value::String(text) => Some((key, text.clone())),
        value => Some((key, value.to_string())),
    };
    let machine = uname().ok();
    let said = |part: Option<&std::ffi::OsStr>| {
        part.map(|words| words.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    About {
        software: concat!("fccd ", env!("CARGO_PKG_VERSION")).to_owned(),
        git_hash: env!("FCCD_GIT_HASH").to_owned(),
        host: said(machine.as_ref().map(UtsName::nodename)),
        kernel: [
            said(machine.as_ref().map(UtsName::sysname)),
            said(machine.as_ref().map(UtsName::release)),
            said(machine.as_ref().map(UtsName::version)),
            said(machine.as_ref().map(UtsName::machine)),
        ]
        .join(" "),
        plant: plant.to_owned(),
        rate_hz,
        config_as_given: as_given,
        config: toml::to_string(config).unwrap_or_default(),
        parameters: values.filter_map(parameter).collect(),
        ..About::default()
    }
}

/// The interval at which the recorder's status is reported.
const REPORT_EVERY: Duration = Duration::from_secs(1);

/// Records the run of a loop.
pub(crate) struct FlightRecorder<C: Recorded> {
    settings: RecorderSettings,
    about: About,
    recorder: Option<RecorderOf<C>>,
    /// When its status was last reported.
    reported: Instant,
}

impl<C: Recorded> FlightRecorder<C> {
    pub(crate) fn new(request: RecordingRequest) -> Self {
        Self {
            settings: request.settings,
            about: request.about,
            recorder: None,
            reported: Instant::now(),
        }
    }
}

impl<C: Recorded> Observer<C> for FlightRecorder<C> {
    /// Begins to record; without a recorder the flight continues, and this is
    /// reported.
    fn begin(&mut self, facts: &Facts<'_>, reports: &mut Reports) {
        let about = About {
            timer: facts.timer.to_owned(),
            sensors: facts.sensors.to_vec(),
            actuators: facts.actuators.to_vec(),
            started_unix_ns: facts.started_unix_ns,
            clock_offset_ns: facts.clock_offset_ns,
            realtime: facts.granted.map(Realtime::from).unwrap_or_default(),
            ..self.about.clone()
        };
        let settings = RecorderSettings {
            pace: match facts.pace {
                Pace::RealTime => RecordingPace::RealTime,
                Pace::Lockstep => RecordingPace::Lockstep,
            },
            ..self.settings.clone()
        };
        match RecorderOf::start(about, settings) {
            Ok(recorder) => self.recorder = Some(recorder),
            Err(error) => reports.remark(format!("not recorded: no thread: {error}")),
        }
    }

    fn record(&mut self, record: &RecordOf<C>, _: &FlightTime) {
        if let Some(recorder) = &mut self.recorder {
            recorder.take(&MessageOf::<C>::Tick(*record));
        }
    }

    fn event(&mut self, event: &EventOf<C>, _: &str, _: &FlightTime) {
        if let Some(recorder) = &mut self.recorder {
            recorder.take(&MessageOf::<C>::Event(*event));
        }
    }

    fn report(&mut self, report: &Report, _: &FlightTime) {
        match (&self.recorder, report) {
            (Some(recorder), Report::Remark(words)) => recorder.remark(words.clone()),
            (Some(recorder), Report::Plan(plan)) => recorder.document(plan.document()),
            _ => {}
        }
    }

    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        let Some(recorder) = &self.recorder else {
            return;
        };
        while let Some(notice) = recorder.notice() {
            pass_on(notice, access.reports);
        }
        if self.reported.elapsed() >= REPORT_EVERY {
            self.reported = Instant::now();
            access.reports.recording(recorder.status());
        }
    }

    /// Ends the recording and waits for the disk, for a limited time.
    fn end(&mut self, ending: &str, outcome: &mut Outcome, reports: &mut Reports) {
        let Some(recorder) = self.recorder.take() else {
            outcome.was_not_recorded();
            return;
        };
        let (status, notices) = recorder.finish(ending);
        for notice in notices {
            pass_on(notice, reports);
        }
        // Finished parts may be deleted too.
        let (files, deleted): (Vec<_>, Vec<_>) =
            status.files.into_iter().partition(|file| file.exists());
        for file in &deleted {
            let file = file.display();
            reports.remark(format!("{file}: was deleted or renamed in flight"));
        }
        if !deleted.is_empty()
            || status.stopped.is_some()
            || status.not_recorded > 0
            || outcome.records_dropped > 0
        {
            outcome.was_not_recorded();
        }
        outcome.recording = Some(RecordingOutcome {
            files: files
                .iter()
                .map(|path| path.display().to_string())
                .collect(),
            ticks: status.ticks,
            bytes: status.bytes,
            not_recorded: status.not_recorded,
            stopped: status.stopped,
        });
    }
}

fn pass_on(notice: Notice, reports: &mut Reports) {
    if notice.is_trouble {
        reports.remark(notice.text);
    } else {
        reports.mention(notice.text);
    }
}
