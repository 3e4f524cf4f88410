//! Lets others watch a flight, live.

use std::ops::RangeInclusive;

use fcc_core::flight::AutopilotCommand;
use fcc_runtime::CommandSender;
use fcc_telemetry::live::{Event, Info, Publisher, RecorderState, RecorderStatus, Text};
use fcc_telemetry::{FlightEvent, FlightRecord, recording};
use fcc_timer::RealtimeGranted;

use super::commands::Commands;
use crate::config::{LoopSection, TelemetrySection};

/// Lets others watch a flight and give it commands; where that cannot be, nothing
/// comes of it.
pub(super) struct Live {
    publisher: Option<Publisher>,
    /// Why there is none, until it is reported.
    trouble: Option<String>,
    commands: Commands,
}

impl Live {
    /// Nobody may watch.
    pub(super) fn off() -> Self {
        Self {
            publisher: None,
            trouble: None,
            // Nobody gives any.
            commands: Commands::new(f64::NEG_INFINITY..=f64::INFINITY),
        }
    }

    /// Begins to publish, if that is wanted. Without shared memory the flight
    /// goes on, and says so. Commands are held to these airspeeds, m/s.
    pub(super) fn start(section: &TelemetrySection, airspeeds_mps: RangeInclusive<f64>) -> Self {
        if !section.enabled {
            return Self::off();
        }
        let start = if section.commands {
            Publisher::start_with_commands
        } else {
            Publisher::start
        };
        match start(&section.instance) {
            Ok(publisher) => Self {
                publisher: Some(publisher),
                trouble: None,
                commands: Commands::new(airspeeds_mps),
            },
            Err(error) => Self {
                trouble: Some(format!(
                    "no live telemetry, so nobody can watch this flight: {error}"
                )),
                ..Self::off()
            },
        }
    }

    /// Says who flies: from here on it can be watched.
    pub(super) fn describe(
        &mut self,
        tick: &LoopSection,
        granted: &RealtimeGranted,
        aircraft: &str,
    ) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        let refusals: Vec<_> = granted.denied.iter().map(ToString::to_string).collect();
        publisher.describe(Info {
            rate_hz: tick.rate_hz,
            timer: Text::new(tick.timer.name()),
            software: Text::new(env!("CARGO_PKG_VERSION")),
            commit: Text::new(env!("FCCD_GIT_HASH")),
            policy: Text::new(granted.policy),
            priority: granted.priority,
            memory_locked: granted.memory_locked.into(),
            requests_denied: refusals.len() as u32,
            refusals: Text::new(&refusals.join("\n")),
            aircraft: Text::new(aircraft),
            ..Info::of_this_process()
        });
    }

    /// Publishes a tick.
    pub(super) fn record(&mut self, record: &FlightRecord) {
        if let Some(publisher) = &mut self.publisher {
            publisher.record(record);
            while let Some((id, verdict)) = self.commands.verdict(record) {
                publisher.answer(id, verdict);
            }
        }
    }

    /// Publishes what happened once, told in words by `text`.
    pub(super) fn event(&mut self, event: &FlightEvent, text: &str) {
        if let Some(publisher) = &mut self.publisher {
            publisher.event(Event::new(event, text));
            self.commands.event(event);
        }
    }

    /// Publishes something that the loop itself does not know.
    pub(super) fn remark(&mut self, tick: u64, time_ns: i64, text: &str) {
        if let Some(publisher) = &mut self.publisher {
            publisher.event(Event::remark(tick, time_ns, text));
        }
    }

    /// Publishes how the recorder does.
    pub(super) fn recorder(&mut self, now: &recording::RecorderStatus) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        let name = now.file.as_ref().and_then(|file| file.file_name());
        publisher.recorder(RecorderStatus {
            state: match (&now.stopped, name) {
                (None, Some(_)) => RecorderState::Recording,
                (None, None) => RecorderState::Off,
                (Some(_), _) => RecorderState::Stopped,
            },
            recorded: now.ticks,
            not_recorded: now.not_recorded,
            bytes: now.bytes,
            name: match &now.stopped {
                Some(why) => why.clone(),
                None => name.unwrap_or_default().to_string_lossy().into_owned(),
            },
        });
    }

    /// Sends the loop what other programs have ordered.
    pub(super) fn pass_commands(&mut self, to: &mut CommandSender<AutopilotCommand>) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        while let Some(asked) = publisher.next_command() {
            if let Some((id, verdict)) = self.commands.send(asked, to) {
                publisher.answer(id, verdict);
            }
        }
    }

    /// Publishes now what was handed over; gives words if there is trouble.
    pub(super) fn poll(&mut self) -> Option<String> {
        let Some(publisher) = self.publisher.as_mut() else {
            return self.trouble.take();
        };
        publisher.flush();
        publisher.poll()
    }
}
