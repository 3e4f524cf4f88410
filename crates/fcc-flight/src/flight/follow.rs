//! Follows a running loop: fetches what it tells, and hands it on to those that
//! may wait.

use std::thread;
use std::time::Duration;

use fcc_core::framework::{Event, EventKind, Message};
use fcc_runtime::Link;
use fcc_telemetry::FlightMessage;

use super::Pilot;
use super::connection::Connection;
use super::hang::{HangWatch, Hung};
use super::instance_lock::InstanceLock;
use super::plan::Plan;
use super::recording::Recording;
use super::run_statistics::RunStatistics;
use super::watch::Watch;

/// How often what the loop tells is fetched: often enough to look alive, and
/// seldom enough to cost nothing.
const FETCH_EVERY: Duration = Duration::from_millis(20);

/// A loop, and those that hear of it.
pub(super) struct Follower<'a> {
    pub(super) link: &'a mut Link<Pilot>,
    pub(super) watch: &'a mut Watch,
    pub(super) recording: Option<&'a mut Recording>,
    /// Only of a loop in real time: one in lockstep gives its own account.
    pub(super) run_statistics: Option<&'a mut RunStatistics>,
    /// The right to fly what is flown, where somebody else may have it.
    pub(super) instance_lock: Option<&'a mut InstanceLock>,
    pub(super) plan: Plan,
}

impl Follower<'_> {
    /// Fetches all there is, and stops the loop when its time is up.
    pub(super) fn drain(&mut self) {
        while let Some(message) = self.link.messages.receive() {
            self.take(&message);
            if self.watch.is_over(self.plan.length) {
                self.link.stop.stop();
            }
        }
        if let Some(recording) = &mut self.recording {
            recording.tell(self.watch);
        }
    }

    /// Follows a loop in its own thread until it is over, or hangs, and passes
    /// on what those around it have to say; `news` is what there is from before.
    pub(super) fn follow(
        &mut self,
        mut connection: Option<&mut Connection>,
        watchdog: Option<&HangWatch>,
        mut news: Option<String>,
    ) -> Option<Hung> {
        let mut hung = None;
        #[cfg(feature = "fault-injection")]
        let mut pause = super::injection::Pause::from_environment();
        while hung.is_none() && !self.link.messages.is_over() {
            #[cfg(feature = "fault-injection")]
            pause.look();
            self.drain();
            if let Some(instance_lock) = &mut self.instance_lock {
                instance_lock.follow();
                if instance_lock.taken().is_some() {
                    self.link.stop.stop();
                }
            }
            self.watch.service.tell();
            self.watch.live.pass_commands(&mut self.link.commands);
            let said = [
                news.take(),
                self.watch
                    .poll_restart(&mut self.link.commands, connection.as_deref_mut()),
                connection.as_deref_mut().and_then(Connection::poll),
                self.watch.live.poll(),
            ];
            for words in said.into_iter().flatten() {
                if let Some(recording) = &self.recording {
                    recording.remark(&words);
                }
                self.watch.remark(words);
            }
            hung = watchdog.and_then(HangWatch::hung);
            thread::sleep(FETCH_EVERY);
        }
        self.drain();
        if let Some(hung) = hung {
            self.tell_of_hang(hung);
        }
        hung
    }

    /// Records that the loop hung, after the last it told.
    fn tell_of_hang(&mut self, hung: Hung) {
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
        self.watch.remark(
            if hung.released {
                "the watchdog gave the controls back and ends the program"
            } else {
                "the watchdog ends the program; it is not known that the controls are back: the \
                 guard process goes on trying for two minutes"
            }
            .to_owned(),
        );
    }

    fn take(&mut self, message: &FlightMessage) {
        self.watch.take(message);
        if let Some(run_statistics) = &mut self.run_statistics {
            run_statistics.take(message);
        }
        if let Some(recording) = &mut self.recording {
            recording.take(message);
        }
    }
}
