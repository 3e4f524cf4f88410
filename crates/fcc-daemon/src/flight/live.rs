//! Lets others watch a flight, live.

use fcc_telemetry::live::{Event, Info, Publisher, RecorderState, RecorderStatus, Text};
use fcc_telemetry::{FlightEvent, FlightRecord, recording};
use fcc_timer::RealtimeGrants;

use crate::config::{LoopSection, TelemetrySection};

/// Lets others watch a flight; where that cannot be, nothing comes of it.
pub(super) struct Live {
    publisher: Option<Publisher>,
}

impl Live {
    /// Nobody may watch.
    pub(super) const fn off() -> Self {
        Self { publisher: None }
    }

    /// Begins to publish, if that is wanted. Without shared memory the flight
    /// goes on, and says so.
    pub(super) fn start(section: &TelemetrySection) -> Self {
        if !section.enabled {
            return Self::off();
        }
        let publisher = Publisher::start(&section.instance)
            .inspect_err(|error| {
                eprintln!("no live telemetry, so nobody can watch this flight: {error}");
            })
            .ok();
        Self { publisher }
    }

    /// Says who flies: from here on it can be watched.
    pub(super) fn describe(&mut self, tick: &LoopSection, grants: &RealtimeGrants, aircraft: &str) {
        let Some(publisher) = &mut self.publisher else {
            return;
        };
        let refusals: Vec<_> = grants.refused.iter().map(ToString::to_string).collect();
        publisher.describe(Info {
            rate_hz: tick.rate_hz,
            timer: Text::new(tick.timer.name()),
            software: Text::new(env!("CARGO_PKG_VERSION")),
            commit: Text::new(env!("FCCD_GIT_HASH")),
            policy: Text::new(grants.policy),
            priority: grants.priority,
            memory_locked: grants.memory_locked.into(),
            wishes_refused: refusals.len() as u32,
            refusals: Text::new(&refusals.join("\n")),
            aircraft: Text::new(aircraft),
            ..Info::of_this_process()
        });
    }

    /// Publishes a tick.
    pub(super) fn record(&mut self, record: &FlightRecord) {
        if let Some(publisher) = &mut self.publisher {
            publisher.record(record);
        }
    }

    /// Publishes what happened once, told in words by `text`.
    pub(super) fn event(&mut self, event: &FlightEvent, text: &str) {
        if let Some(publisher) = &mut self.publisher {
            publisher.event(Event::new(event, text));
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

    /// Publishes now what was handed over; gives words if there is trouble.
    pub(super) fn poll(&mut self) -> Option<String> {
        let publisher = self.publisher.as_mut()?;
        publisher.flush();
        publisher.poll()
    }
}
