//! Sends commands.

use std::time::{Duration, Instant};

use iceoryx2::port::client::Client;
use iceoryx2::prelude::BackpressureStrategy;
use iceoryx2::service::builder::request_response::RequestResponseOpenError;

use super::super::connected::Connected;
use super::super::place::{FoundPlace, Presence};
use super::super::row_watcher::{PATIENCE as FOUND_WITHIN, check_layout, read_info};
use super::super::services::{self, Access, Ipc};
use super::super::{Info, Text, WatchError};
use super::{Answer, CommandRequest};
use super::{COMMANDS_VERSION, Command, CommandError, InvalidCommand, Verdict, command_server};
use fcc_telemetry::Instance;

/// How long a daemon may take to answer: about ten times what it takes at the
/// slowest rate, 1 Hz.
const PATIENCE: Duration = Duration::from_secs(10);
/// How much longer a stop may take: the loop prepares the plant for its release
/// for 12 s at most.
const STOPS_WITHIN: Duration = Duration::from_secs(12);
const LOOK_EVERY: Duration = Duration::from_millis(2);

/// Sends commands to a daemon, or to the loop of any other plant, on this
/// machine.
///
/// ```no_run
/// use fcc_telemetry::Instance;
/// use fcc_live::{Command, Commander};
///
/// let mut commander = Commander::open(&Instance::default(), "the tower")?;
/// commander.command(&Command::Engage)?;
/// let tick = commander.command(&Command::set([("heading_rad", 1.57)]))?;
/// println!("carried out in tick {tick}");
/// # Ok::<(), fcc_live::CommandError>(())
/// ```
#[derive(Debug)]
pub struct Commander {
    instance: Instance,
    info: Info,
    sender: String,
    connected: Connected<Opened>,
}

#[derive(Debug)]
struct Opened {
    info: Info,
    client: Client<Ipc, CommandRequest, (), Answer, ()>,
    // Dropped last: it cleans up after the others.
    _access: Access,
}

impl Opened {
    fn at(place: &FoundPlace, instance: &Instance) -> Result<Self, CommandError> {
        let access = services::access(&place.root).map_err(WatchError::NoSharedMemory)?;
        let info = read_info(&access, place, instance, FOUND_WITHIN)?;
        check_layout(&info, instance)?;
        Ok(Self {
            info,
            client: client(&access, instance, &info)?,
            _access: access,
        })
    }
}

fn client(
    access: &Access,
    instance: &Instance,
    info: &Info,
) -> Result<Client<Ipc, CommandRequest, (), Answer, ()>, CommandError> {
    let name = command_server::service_name(instance)
        .ok_or_else(|| WatchError::NotRunning(instance.clone()))?;
    let not_accepted = || CommandError::NotAccepted {
        instance: instance.clone(),
        software: info.software.as_str().to_owned(),
        own: COMMANDS_VERSION,
    };
    let service = access
        .service_builder(&name)
        .request_response::<CommandRequest, Answer>()
        .open()
        .map_err(|error| refused(error, instance, not_accepted))?;
    service
        .client_builder()
        .backpressure_strategy(BackpressureStrategy::DiscardData)
        .create()
        .map_err(|_| CommandError::TooMany(instance.clone()))
}

impl Commander {
    /// Connects to a daemon. `sender` is who commands, in at most 64 bytes: recorded
    /// with the flight.
    ///
    /// # Errors
    /// When no daemon of this name runs here, it is another version, or it
    /// accepts no commands.
    pub fn open(instance: &Instance, sender: &str) -> Result<Self, CommandError> {
        let connected = Connected::open(instance, |place| Opened::at(place, instance))?;
        Ok(Self {
            instance: instance.clone(),
            info: connected.ports()?.info,
            sender: sender.to_owned(),
            connected,
        })
    }

    /// Connects again if another process now receives commands for the same
    /// daemon.
    fn follow(&mut self) -> Result<(), CommandError> {
        self.connected.ports()?;
        if self.connected.place.now() == Presence::Here(self.connected.place.clone()) {
            return Ok(());
        }
        let again = Self::open(&self.instance, &self.sender)?;
        if again.info.process_id == self.info.process_id {
            *self = again;
            Ok(())
        } else {
            Err(WatchError::NotRunning(self.instance.clone()).into())
        }
    }

    /// The daemon.
    pub const fn info(&self) -> &Info {
        &self.info
    }

    /// Sends a command and waits until it is carried out; returns the tick that
    /// did. A stop may take 12 s: the plant is prepared for its release first.
    ///
    /// # Errors
    /// When the daemon refuses the command, has ended, or does not answer.
    pub fn command(&mut self, command: &Command) -> Result<u64, CommandError> {
        let mut request = CommandRequest::try_from(command)?;
        request.sender = Text::new(&self.sender);
        self.follow()?;
        let gone = || CommandError::Unreachable(WatchError::NotRunning(self.instance.clone()));
        let pending = self
            .connected
            .ports()?
            .client
            .send_copy(request)
            .map_err(|error| WatchError::NoSharedMemory(services::explained(&error)))?;
        let patience = match command {
            Command::Stop => PATIENCE + STOPS_WITHIN,
            _ => PATIENCE,
        };
        let deadline = Instant::now() + patience;
        loop {
            // Checked first: an answer sent before the daemon ended counts.
            let connected = pending.is_connected();
            match pending.receive() {
                Ok(Some(answer)) => {
                    return match answer.verdict() {
                        Verdict::CarriedOut { tick } => Ok(tick),
                        Verdict::Refused(words) => Err(CommandError::Refused(words)),
                        Verdict::Outside(outside) => Err(InvalidCommand::from(outside).into()),
                    };
                }
                Ok(None) if !connected => return Err(gone()),
                Ok(None) => {}
                Err(error) => {
                    return Err(WatchError::NoSharedMemory(services::explained(&error)).into());
                }
            }
            if Instant::now() > deadline {
                return Err(CommandError::NoAnswer(
                    self.instance.clone(),
                    patience.as_secs(),
                ));
            }
            std::thread::sleep(LOOK_EVERY);
        }
    }
}

fn refused(
    error: RequestResponseOpenError,
    instance: &Instance,
    not_accepted: impl Fn() -> CommandError,
) -> CommandError {
    use RequestResponseOpenError as Open;
    match error {
        Open::DoesNotExist
        | Open::IsMarkedForDestruction
        | Open::HangsInCreation
        | Open::IncompatibleRequestOrResponseType => not_accepted(),
        Open::ExceedsMaxNumberOfNodes => CommandError::TooMany(instance.clone()),
        Open::InsufficientPermissions => WatchError::NotPermitted(instance.clone()).into(),
        error => WatchError::NoSharedMemory(services::explained(&error)).into(),
    }
}
