//! Reads the messages of a running loop, and passes them to the observers.

use std::sync::Arc;
use std::thread;
use std::time::Duration;

use fcc_core::framework::{ControlAuthority, Event, EventKind, Message};
use fcc_runtime::Link;
use fcc_telemetry::FlightMessage;

use super::ground::GroundWatch;
use super::hang::{HangWatch, Hung};
use super::host::Host;
use super::observers::Observers;
use super::outcome::Over;
use super::pilot::Pilot;
use super::plan::Length;
use super::run_statistics::RunStatistics;

/// The interval at which the loop's messages are read: short enough for a live
/// display, long enough to cost little.
const FETCH_EVERY: Duration = Duration::from_millis(10);

/// A loop and its observers.
pub(super) struct Follower<'a> {
    pub(super) link: &'a mut Link<Pilot>,
    pub(super) observers: &'a mut Observers,
    pub(super) host: &'a mut dyn Host,
    /// Only for a loop in real time: one in lockstep returns its own
    /// statistics.
    pub(super) run_statistics: Option<&'a mut RunStatistics<Pilot>>,
    pub(super) length: Length,
    pub(super) ground: &'a mut GroundWatch,
}

impl Follower<'_> {
    /// Reads all messages, stops the loop when its time is over or its aircraft
    /// on the ground, and polls each observer.
    pub(super) fn drain(&mut self) {
        while let Some(message) = self.link.messages.receive() {
            self.take(&message);
            if let Some(over) = self.observers.list.monitor.over(self.length) {
                self.link.stop.stop();
                if over == Over::Ground {
                    self.ground.touch();
                }
            }
        }
        if let Some(impact) = self.ground.hits() {
            self.observers.list.remark(impact.to_string());
            self.link.stop.stop();
        }
        self.observers.list.poll(&mut self.link.commands, self.host);
    }

    /// Follows a loop in its own thread until it ends or hangs.
    pub(super) fn follow(
        &mut self,
        authority: Option<&Arc<dyn ControlAuthority>>,
        mut watchdog: Option<&mut HangWatch>,
    ) -> Option<Hung> {
        let mut hung = None;
        #[cfg(feature = "fault-injection")]
        let mut pause = super::injection::Pause::from_environment();
        while hung.is_none() && !self.link.messages.is_over() {
            #[cfg(feature = "fault-injection")]
            pause.look();
            self.drain();
            self.host
                .poll(&mut |words| self.observers.list.remark(words));
            if self.host.taken_by_another().is_some() {
                self.link.stop.stop();
            }
            if let Some(authority) = authority {
                authority.report(&mut |words| self.observers.list.remark(words.to_string()));
            }
            hung = watchdog.as_mut().and_then(|watchdog| {
                watchdog.look(self.link, &mut |words| self.observers.list.remark(words))
            });
            thread::sleep(FETCH_EVERY);
        }
        self.drain();
        if let Some(hung) = hung {
            self.report_hang(hung);
        }
        hung
    }

    /// Records that the loop hung, after the last it reported.
    fn report_hang(&mut self, hung: Hung) {
        let last = self
            .run_statistics
            .as_ref()
            .map(|run_statistics| run_statistics.last().tick);
        let last = last.unwrap_or_default();
        self.take(&Message::Event(Event {
            tick: last.number,
            time: last.woke,
            kind: EventKind::Hung {
                silent_ns: hung.silent.as_nanos() as u64,
            },
        }));
        self.observers.list.remark(if hung.released {
            "the watchdog released the controls and ends the program".to_owned()
        } else {
            format!(
                "the watchdog ends the program; the release of the controls is not confirmed{}",
                self.host.continues_release()
            )
        });
    }

    fn take(&mut self, message: &FlightMessage) {
        self.observers.take(message);
        if let Some(run_statistics) = &mut self.run_statistics {
            run_statistics.take(message);
        }
    }
}
