//! Flights of the built-in aircraft in lockstep.

use std::path::{Path, PathBuf};
use std::time::Duration;

use fcc_core::flight::Measurements;
use fcc_core::framework::{Sensor, SensorFault, State, Tick};
use fcc_flight::config::{BuiltInSection, Config};
use fcc_flight::flight::assemble;
use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
use fcc_runtime::{Machine, Parts};
use fcc_telemetry::{Denial, FlightMessage, Realtime};
use fcc_timer::ManualTimer;

/// A remark at the end of a recorded flight.
pub(super) const REMARK: &str = "the wind is <light>";

/// Plan of a flight.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    pub(super) rate_hz: u32,
    pub(super) ticks: u32,
    /// From this tick on the sensors are silent.
    pub(super) silent_from: Option<u64>,
}

impl Plan {
    /// This many seconds at 40 Hz: 2 s of standby, then the timed pattern.
    pub(super) fn seconds(seconds: u32) -> Self {
        Self {
            rate_hz: 40,
            ticks: 40 * seconds,
            silent_from: None,
        }
    }

    /// Flies, and passes on the messages of the loop.
    pub(super) fn fly(self, mut take: impl FnMut(&FlightMessage)) {
        let assembly = assemble(&config(self.rate_hz)).unwrap();
        let silent_from = self.silent_from.unwrap_or(u64::MAX);
        let parts = Parts {
            timer: Box::new(ManualTimer::new(Duration::from_secs(1) / self.rate_hz).unwrap()),
            sensors: assembly
                .sensors
                .into_iter()
                .map(|sensor| -> Box<dyn Sensor<Measurements>> {
                    Box::new(Falling {
                        sensor,
                        silent_from,
                    })
                })
                .collect(),
            controller: *assembly.autopilot,
            actuators: assembly.actuators,
        };
        let (mut machine, mut link) = Machine::new(parts, &assembly.loop_config).unwrap();
        machine.start().unwrap();
        for tick in 1..=self.ticks {
            if tick == self.ticks {
                link.stop.stop();
            }
            let state = machine.step();
            while let Some(message) = link.messages.receive() {
                take(&message);
            }
            if state == State::Stopped {
                break;
            }
        }
    }

    /// Flies and records into a folder.
    pub(super) fn record(self, folder: &Path) -> PathBuf {
        let settings = RecorderSettings {
            pace: RecordingPace::Lockstep,
            ..RecorderSettings::new(folder)
        };
        let mut recorder = Recorder::start(about(self.rate_hz), settings).unwrap();
        self.fly(|message| recorder.take(message));
        recorder.remark(REMARK.to_owned());
        let (status, _) = recorder.finish("stop requested");
        status.files[0].clone()
    }
}

fn config(rate_hz: u32) -> Config {
    let mut config = Config {
        built_in: Some(BuiltInSection::default()),
        ..Config::default()
    };
    config.tick.rate_hz = f64::from(rate_hz);
    // A silent aircraft is lost as soon as a silent sensor.
    config.failsafe.all_silent_s = 0.25;
    config
}

fn about(rate_hz: u32) -> About {
    About {
        software: "fccd <test> & \"co\"".to_owned(),
        git_hash: "0123456789ab".to_owned(),
        host: "bench".to_owned(),
        kernel: "Linux".to_owned(),
        plant: "built-in".to_owned(),
        rate_hz: f64::from(rate_hz),
        timer: "manual".to_owned(),
        sensors: vec!["built-in aircraft".to_owned()],
        actuators: vec!["built-in aircraft".to_owned()],
        realtime: Realtime {
            policy: "SCHED_OTHER".to_owned(),
            refused: vec![Denial {
                request: "SCHED_FIFO 80 was refused".to_owned(),
                remedy: "give CAP_SYS_NICE".to_owned(),
                ..Denial::default()
            }],
            ..Realtime::default()
        },
        started_unix_ns: 1_795_148_493_000_000_000,
        config: toml::to_string(&config(rate_hz)).unwrap(),
        part: 1,
        ..About::default()
    }
}

/// A sensor that becomes silent.
struct Falling {
    sensor: Box<dyn Sensor<Measurements>>,
    silent_from: u64,
}

impl Sensor<Measurements> for Falling {
    fn sample(&mut self, tick: &Tick, into: &mut Measurements) -> Result<(), SensorFault> {
        if tick.number >= self.silent_from {
            return Err(SensorFault::Silent);
        }
        self.sensor.sample(tick, into)
    }

    fn name(&self) -> &'static str {
        "falling"
    }
}
