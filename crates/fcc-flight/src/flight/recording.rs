//! A flight's recording, as the flight sees it.

use std::collections::BTreeMap;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use fcc_telemetry::FlightMessage;
use fcc_telemetry::recording::{About, News, Realtime, Recorder, RecorderSettings, repair_last};
use fcc_timer::RealtimeGranted;
use fcc_timer::realtime::LatencyLimit;
use nix::sys::utsname::{UtsName, uname};

use super::outcome::RecordingOutcome;
use super::watch::Watch;
use crate::config::{Aircraft, Config};

/// How a flight is to be recorded.
#[derive(Clone, Debug)]
pub struct RecordingRequest {
    settings: RecorderSettings,
    about: About,
}

impl RecordingRequest {
    /// Records a configuration's flight, if it says so; `as_given` is the text
    /// of its file.
    pub fn of(config: &Config, as_given: Option<String>) -> Option<Self> {
        let section = &config.recording;
        section.enabled.then(|| Self {
            settings: RecorderSettings::from(section),
            about: about(config, as_given),
        })
    }
}

/// What is known of a flight by its configuration and its machine.
pub fn about(config: &Config, as_given: Option<String>) -> About {
    let aircraft = match config.aircraft() {
        Aircraft::XPlane(_) => "x-plane",
        Aircraft::BuiltIn(_) => "built-in",
    };
    let mut parameters = BTreeMap::new();
    // A configuration that was read can be written.
    if let Ok(values) = toml::Value::try_from(config) {
        flatten(String::new(), &values, &mut parameters);
    }
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
        aircraft: aircraft.to_owned(),
        rate_hz: config.tick.rate_hz,
        config_as_given: as_given,
        config: toml::to_string(config).unwrap_or_default(),
        parameters,
        ..About::default()
    }
}

fn flatten(key: String, value: &toml::Value, into: &mut BTreeMap<String, String>) {
    match value {
        toml::Value::Table(table) => {
            for (name, value) in table {
                let key = match key.as_str() {
                    "" => name.clone(),
                    section => format!("{section}.{name}"),
                };
                flatten(key, value, into);
            }
        }
        toml::Value::String(text) => {
            into.insert(key, text.clone());
        }
        value => {
            into.insert(key, value.to_string());
        }
    }
}

/// The recording of a flight that is being flown.
pub(super) struct Recording {
    recorder: Recorder,
    /// When its status was last published.
    told: Instant,
}

/// How often watchers are told how the recorder does.
const TELL_EVERY: Duration = Duration::from_secs(1);

/// What a recording has to know of its loop.
pub(super) struct LoopFacts {
    pub(super) timer: &'static str,
    /// The loop's clock, read right now.
    pub(super) now_ns: i64,
    pub(super) sensors: Vec<String>,
    pub(super) actuators: Vec<String>,
}

impl RecordingRequest {
    /// Takes what the loop knows of itself, and repairs what the last flight
    /// may have left. To be called before the loop's clock matters.
    pub(super) fn prepare(&mut self, facts: LoopFacts, watch: &mut Watch) {
        let now_unix_ns = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |since| since.as_nanos() as u64);
        self.about = About {
            timer: facts.timer.to_owned(),
            sensors: facts.sensors,
            actuators: facts.actuators,
            started_unix_ns: now_unix_ns,
            clock_offset_ns: (now_unix_ns as i64).saturating_sub(facts.now_ns),
            ..std::mem::take(&mut self.about)
        };
        match repair_last(&self.settings.folder) {
            Ok(None) => {}
            Ok(Some(repaired)) => watch.mention(&format!(
                "{}: was cut off, repaired: {} ticks",
                repaired.path.display(),
                repaired.ticks
            )),
            Err(error) => watch.remark(format!("the last recording was not repaired: {error}")),
        }
    }

    /// Begins to record; without a recorder the flight goes on, and says so.
    pub(super) fn begin(
        self,
        granted: Option<&RealtimeGranted>,
        pace: fcc_telemetry::recording::RecordingPace,
        watch: &mut Watch,
    ) -> Option<Recording> {
        let realtime = granted.map_or_else(Realtime::default, |granted| Realtime {
            policy: granted.policy.to_owned(),
            priority: granted.priority,
            cpu: granted.cpu,
            cpu_because: granted.cpu_reason.clone(),
            memory_locked: granted.memory_locked,
            stack_prefaulted: granted.stack_prefaulted,
            timer_slack_ns: granted.timer_slack_ns,
            cpu_dma_latency_us: granted.cpu_latency.as_ref().map(LatencyLimit::us),
            refused: granted.denied.iter().map(ToString::to_string).collect(),
        });
        let about = About {
            realtime,
            ..self.about
        };
        let settings = RecorderSettings {
            pace,
            ..self.settings
        };
        Recorder::start(about, settings)
            .inspect_err(|error| watch.remark(format!("not recorded: no thread: {error}")))
            .ok()
            .map(|recorder| Recording {
                recorder,
                told: Instant::now(),
            })
    }
}

impl Recording {
    /// Records a message.
    pub(super) fn take(&mut self, message: &FlightMessage) {
        self.recorder.take(message);
    }

    /// Records words.
    pub(super) fn remark(&self, text: &str) {
        self.recorder.remark(text.to_owned());
    }

    /// Passes on what there is to say.
    pub(super) fn tell(&mut self, watch: &mut Watch) {
        while let Some(news) = self.recorder.news() {
            tell(&news, watch);
        }
        if self.told.elapsed() >= TELL_EVERY {
            self.told = Instant::now();
            watch.live.recorder(&self.recorder.status());
        }
    }

    /// Ends the recording and waits for the disk, for a while.
    pub(super) fn end(self, ending: &str, watch: &mut Watch) -> RecordingOutcome {
        let (status, news) = self.recorder.finish(ending);
        for news in &news {
            tell(news, watch);
        }
        RecordingOutcome {
            files: status
                .files
                .iter()
                .map(|path| path.display().to_string())
                .collect(),
            ticks: status.ticks,
            bytes: status.bytes,
            not_recorded: status.not_recorded,
            stopped: status.stopped,
        }
    }
}

fn tell(news: &News, watch: &mut Watch) {
    if news.is_trouble {
        watch.remark(news.text.clone());
    } else {
        watch.mention(&news.text);
    }
}
