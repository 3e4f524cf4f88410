//! The socket at which the daemon receives commands of other users.

use std::fs::{self, DirBuilder, Permissions};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::fd::AsFd as _;
use std::os::unix::fs::{DirBuilderExt as _, MetadataExt as _, PermissionsExt as _};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fcc_core::framework::{Controller, EventOf, RecordOf};
use fcc_fixed_wing::Setpoints;
use fcc_live::{Commandable, PendingCommand, PlantLimits, SentCommands, Verdict};
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::socket::{Backlog, getsockopt, listen, sockopt::PeerCredentials};
use nix::unistd::geteuid;

use super::connect::connect_within;
use super::line::{Line, MOST_BYTES};
use super::own_folder;
use super::panel::Panel;
use super::wire::{command_of, line_of_answer};
use crate::config::Config;
use crate::flight::limits::FlownPlan;
use crate::flight::observer::{Access, FlightTime, Observer, Reports};
use crate::flight::outcome::Outcome;

/// Others may enter the folder, and see nothing in it.
const FOLDER_MODE: u32 = 0o711;
/// Everyone may connect; who is refused gets to know why.
const SOCKET_MODE: u32 = 0o666;
/// Programs that may wait for an answer.
const MOST_PEERS: usize = 16;
/// Of one user: nobody keeps the others from commanding.
const MOST_OF_A_USER: usize = 2;
/// New connections that are taken each fiftieth of a second: 1,000 in a second, which
/// take 2 % of a processor.
const MOST_AT_ONCE: usize = 20;
/// Connections that wait to be taken: those who are not named delay the others by the
/// seventh of a second that these take.
const MOST_WAITING: i32 = 128;
/// A line is sent at once.
const LINE_WITHIN: Duration = Duration::from_secs(2);
/// After this a connection is closed: longer than any command takes.
const PATIENCE: Duration = Duration::from_secs(20);

/// Receives commands of other users, and answers them; never waits.
pub(in crate::flight) struct CommandSocket<C: Commandable> {
    config: Config,
    panel: Panel,
    path: Option<PathBuf>,
    listener: Option<UnixListener>,
    peers: Vec<Peer>,
    next_id: u64,
    commands: SentCommands<C>,
    flown: FlownPlan,
}

struct Peer {
    id: u64,
    user: u32,
    stream: UnixStream,
    since: Instant,
    received: Line,
    /// Its command was sent to the loop.
    is_sent: bool,
}

impl<C: Commandable> CommandSocket<C> {
    pub(in crate::flight) fn new(config: &Config, limits: PlantLimits) -> Self {
        Self {
            config: config.clone(),
            panel: Panel::default(),
            path: None,
            listener: None,
            peers: Vec::new(),
            next_id: 0,
            commands: SentCommands::new(limits),
            flown: FlownPlan::default(),
        }
    }

    fn open(&mut self) -> io::Result<()> {
        let taken = || io::Error::other("another fccd has this name");
        let folder = own_folder(geteuid().as_raw());
        prepare(&folder)?;
        let path = folder.join(self.config.telemetry.instance.to_string());
        match connect_within(&path, Duration::ZERO) {
            Ok(_) => return Err(taken()),
            // It is stopped, and its queue is full.
            Err(error) if error.kind() == ErrorKind::WouldBlock => return Err(taken()),
            // Left by a daemon that was killed, in a folder of this user alone.
            Err(_) => match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
                _ => {}
            },
        }
        let listener = UnixListener::bind(&path)?;
        self.path = Some(path.clone());
        fs::set_permissions(&path, Permissions::from_mode(SOCKET_MODE))?;
        listener.set_nonblocking(true)?;
        listen(&listener, Backlog::new(MOST_WAITING)?)?;
        self.listener = Some(listener);
        Ok(())
    }

    fn accept(&mut self) {
        let Some(listener) = &self.listener else {
            return;
        };
        for _ in 0..MOST_AT_ONCE {
            let Ok((stream, _)) = listener.accept() else {
                return;
            };
            let peer = getsockopt(&stream, PeerCredentials);
            let user = peer.map_or(u32::MAX, |peer| peer.uid());
            let of_user = self.peers.iter().filter(|peer| peer.user == user).count();
            let refusal = match peer {
                Ok(peer) if !self.panel.permits(user, peer.gid()) => Some(format!(
                    "user {user} may not command this fccd: add the name to rights.commanders in \
                     its configuration"
                )),
                Ok(_) if of_user >= MOST_OF_A_USER => Some(format!(
                    "{MOST_OF_A_USER} programs of user {user} wait for an answer already: send it \
                     again"
                )),
                Ok(_) if self.peers.len() >= MOST_PEERS => {
                    Some("too many programs wait for an answer: send it again".to_owned())
                }
                Ok(_) => None,
                Err(error) => Some(format!("it is not known who sent it: {error}")),
            };
            // A new connection has room for a line.
            if stream.set_nonblocking(true).is_err() {
                continue;
            }
            self.next_id += 1;
            let peer = Peer {
                id: self.next_id,
                user,
                stream,
                since: Instant::now(),
                received: Line::default(),
                is_sent: false,
            };
            match refusal {
                Some(why) => peer.answer(&Verdict::Refused(why)),
                None => self.peers.push(peer),
            }
        }
    }

    fn answer(&mut self, id: u64, verdict: &Verdict) {
        if let Some(at) = self.peers.iter().position(|peer| peer.id == id) {
            self.peers.swap_remove(at).answer(verdict);
        }
    }
}

/// Creates the folder if it is missing, and lets others enter it.
fn prepare(folder: &Path) -> io::Result<()> {
    match DirBuilder::new().mode(0o700).create(folder) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    let found = fs::symlink_metadata(folder)?;
    if !found.is_dir() || found.uid() != geteuid().as_raw() {
        let folder = folder.display();
        let why = format!("{folder} is not a folder of this user: remove it");
        return Err(io::Error::other(why));
    }
    fs::set_permissions(folder, Permissions::from_mode(FOLDER_MODE))
}

impl Peer {
    /// The next line, or why there is none; none yet.
    fn line(&mut self) -> Option<Result<String, &'static str>> {
        let mut bytes = [0; MOST_BYTES];
        match self.stream.read(&mut bytes) {
            Ok(0) => Some(Err("it was not sent completely")),
            Ok(read) => self.received.add(bytes.get(..read)?),
            Err(error) if error.kind() == ErrorKind::WouldBlock => None,
            Err(_) => Some(Err("it could not be read")),
        }
    }

    /// Whether the program has closed the connection: it waits for no answer,
    /// and does not expect that its command is still carried out.
    fn is_gone(&self) -> bool {
        let mut asked = [PollFd::new(self.stream.as_fd(), PollFlags::empty())];
        let looked = poll(&mut asked, PollTimeout::ZERO);
        let [found] = asked;
        let closed = PollFlags::POLLHUP | PollFlags::POLLERR;
        looked.is_err() || found.revents().is_none_or(|found| found.intersects(closed))
    }

    /// Answers, without waiting: a program that does not read gets nothing.
    fn answer(mut self, verdict: &Verdict) {
        let _ = self.stream.write(line_of_answer(verdict).as_bytes());
    }
}

impl<C: Commandable + Controller<Setpoints = Setpoints>> Observer<C> for CommandSocket<C> {
    /// Without the socket the flight continues, and this is reported.
    fn prepare(&mut self, reports: &mut Reports) {
        self.panel = Panel::of(&self.config.rights, &mut |report| reports.mention(report));
        if let Err(error) = self.open() {
            reports.mention(format!(
                "other users (rights.commanders) cannot command this flight: {error}"
            ));
        }
    }

    fn record(&mut self, record: &RecordOf<C>, _: &FlightTime) {
        self.flown.follow(&record.setpoints, &mut self.commands);
        let (tick, state) = (record.tick.number, record.state.state());
        while let Some((id, verdict)) = self.commands.verdict(tick, state) {
            self.answer(id, &verdict);
        }
    }

    fn event(&mut self, event: &EventOf<C>, _: &str, _: &FlightTime) {
        self.commands.event(event);
    }

    fn poll(&mut self, access: &mut Access<'_, C::Command>) {
        self.accept();
        let mut answers = Vec::new();
        for peer in self.peers.iter_mut().filter(|peer| !peer.is_sent) {
            let asked = match peer.line() {
                // It may have waited for long: this process was stopped, or hung.
                Some(Ok(line)) if peer.is_gone() => {
                    access.reports.mention(format!(
                        "a command of user {} was not carried out, for its sender has given up: {}",
                        peer.user,
                        line.escape_default()
                    ));
                    Err("its sender has given up")
                }
                Some(line) => line.and_then(|line| command_of(&line)),
                None if peer.since.elapsed() > LINE_WITHIN => Err("it did not come in time"),
                None => continue,
            };
            peer.is_sent = true;
            let verdict = match asked {
                Err(why) => Some((peer.id, Verdict::Refused(why.to_owned()))),
                Ok(command) => {
                    let sender = format!("user {}", peer.user);
                    access.reports.commander(&sender);
                    let asked = PendingCommand {
                        id: peer.id,
                        sender,
                        command,
                    };
                    self.commands.send(asked, |command| {
                        let sent = access.commands.send(command);
                        sent.map_err(|error| error.to_string())
                    })
                }
            };
            answers.extend(verdict);
        }
        for (id, verdict) in answers {
            self.answer(id, &verdict);
        }
        self.peers.retain(|peer| peer.since.elapsed() <= PATIENCE);
    }

    fn end(&mut self, _: &str, _: &mut Outcome, _: &mut Reports) {
        for peer in self.peers.drain(..) {
            peer.answer(&Verdict::Refused("the flight has ended".to_owned()));
        }
        if let Some(path) = self.path.take() {
            let _ = fs::remove_file(path);
        }
    }
}
