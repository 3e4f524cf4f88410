//! Receives commands in the publishing thread: passes them to the flight
//! through a ring, and sends the answers back.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use iceoryx2::active_request::ActiveRequest;
use iceoryx2::port::server::Server;
use iceoryx2::prelude::BackpressureStrategy;
use iceoryx2::service::service_name::ServiceName;

use super::super::PublishError;
use super::super::services::{Access, Ipc, explained};
use super::{Answer, CommandRequest};
use super::{COMMANDS_VERSION, PendingCommand, Verdict};
use fcc_telemetry::Instance;

/// Programs that may give commands to one daemon at the same time.
const MAX_COMMANDERS: usize = 16;
/// Processes that may have the service open: some were killed and are not
/// cleaned up yet.
const MAX_NODES: usize = MAX_COMMANDERS + 16;
/// Commands of one program that may be queued.
const MAX_WAITING: usize = 4;

/// The flight's ends of the rings.
#[derive(Debug)]
pub(in super::super) struct Ends {
    pub(in super::super) commands: Receiver<PendingCommand>,
    pub(in super::super) verdicts: SyncSender<(u64, Verdict)>,
}

/// The server's ends of the same rings, and the next command's identifier.
pub(in super::super) type Rings = (SyncSender<PendingCommand>, Receiver<(u64, Verdict)>, u64);

type Waiting = ActiveRequest<Ipc, CommandRequest, (), Answer, ()>;

/// Receives commands from other programs.
pub(in super::super) struct CommandServer {
    server: Server<Ipc, CommandRequest, (), Answer, ()>,
    waiting: Vec<(u64, Waiting)>,
    commands: SyncSender<PendingCommand>,
    verdicts: Receiver<(u64, Verdict)>,
    next_id: u64,
}

/// The name of the service for commands.
pub(super) fn service_name(instance: &Instance) -> Option<ServiceName> {
    ServiceName::new(&format!("fcc/{instance}/command/v{COMMANDS_VERSION}")).ok()
}

impl CommandServer {
    /// The rings between the server and the flight; `first` is the first
    /// command's identifier.
    pub(in super::super) fn rings(first: u64) -> (Ends, Rings) {
        let room = MAX_COMMANDERS * MAX_WAITING;
        let (commands_in, commands) = sync_channel(room);
        let (verdicts, verdicts_out) = sync_channel(room);
        (
            Ends { commands, verdicts },
            (commands_in, verdicts_out, first),
        )
    }

    /// Opens the service, or creates it.
    pub(in super::super) fn open(
        access: &Access,
        instance: &Instance,
        (commands, verdicts, next_id): Rings,
    ) -> Result<Self, PublishError> {
        let unavailable = |words: String| PublishError::NoSharedMemory(words);
        let name = service_name(instance)
            .ok_or_else(|| unavailable(format!("'{instance}' is not a valid service name")))?;
        let service = access
            .service_builder(&name)
            .request_response::<CommandRequest, Answer>()
            .max_servers(1)
            .max_clients(MAX_COMMANDERS)
            .max_nodes(MAX_NODES)
            .max_active_requests_per_client(MAX_WAITING)
            .max_response_buffer_size(1)
            .enable_fire_and_forget_requests(false)
            .open_or_create()
            .map_err(|error| unavailable(format!("commands: {}", explained(&error))))?;
        let server = service
            .server_builder()
            .backpressure_strategy(BackpressureStrategy::DiscardData)
            .create()
            .map_err(|error| unavailable(format!("commands: {}", explained(&error))))?;
        Ok(Self {
            server,
            waiting: Vec::new(),
            commands,
            verdicts,
            next_id,
        })
    }

    /// Passes on the commands that have arrived, and sends the answers that are
    /// ready.
    pub(in super::super) fn serve(&mut self) {
        while let Ok(Some(request)) = self.server.receive() {
            self.take(request);
        }
        while let Ok((id, verdict)) = self.verdicts.try_recv() {
            if let Some(at) = self.waiting.iter().position(|(waiting, _)| *waiting == id) {
                let (_, request) = self.waiting.swap_remove(at);
                answer(&request, &verdict);
            }
        }
        // A program that has ended needs no answer; its command remains valid.
        self.waiting.retain(|(_, request)| request.is_connected());
    }

    /// The flight has ended: tells all programs that wait for an answer.
    pub(in super::super) fn close(mut self) {
        self.serve();
        let over = Verdict::Refused("the flight has ended".to_owned());
        for (_, request) in &self.waiting {
            answer(request, &over);
        }
    }

    fn take(&mut self, request: Waiting) {
        let command = match request.command() {
            Ok(command) => command,
            Err(words) => return answer(&request, &Verdict::Refused(words)),
        };
        let id = self.next_id;
        self.next_id += 1;
        let asked = PendingCommand {
            id,
            sender: request.sender.as_str().to_owned(),
            command,
        };
        if self.commands.try_send(asked).is_ok() {
            self.waiting.push((id, request));
        } else {
            let words = "too many commands are waiting: send it again".to_owned();
            answer(&request, &Verdict::Refused(words));
        }
    }
}

fn answer(request: &Waiting, verdict: &Verdict) {
    // A program that has ended gets no answer.
    let _ = request.send_copy(Answer::from(verdict));
}
