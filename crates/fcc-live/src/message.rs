//! Messages between a daemon and the process that publishes for it, over a
//! socket that keeps their boundaries.
//!
//! Both are the same program. Neither waits for the other: a message that does
//! not fit into the socket is not sent.

use std::io;
use std::os::fd::{AsFd, AsRawFd, OwnedFd};

use nix::errno::Errno;
use nix::sys::socket::{
    AddressFamily, MsgFlags, SockFlag, SockType, recv, send, setsockopt, socketpair, sockopt,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::command::{PendingCommand, Verdict};
use super::{Event, Info, PublishError, Status};
use fcc_core::framework::schema::Schema;
use fcc_telemetry::Instance;
use fcc_telemetry::schema::{words, write_words};

/// The longest message.
const MOST_BYTES: usize = 16 << 10;
/// What the kernel may keep of messages that wait; it gives less to users
/// without privileges.
const WAITING_BYTES: usize = 2 << 20;

/// Begins a message that is a record, as words.
const RECORD: u8 = 0;
/// Begins every other message.
const OTHER: u8 = 1;

/// To the process that publishes.
#[derive(Serialize, Deserialize, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
pub(super) enum ToPublisher {
    /// The first: what it publishes.
    Begin {
        /// The daemon's name.
        instance: Instance,
        /// Whether it takes commands.
        takes_commands: bool,
        /// The identifier of its first command.
        first_command: u64,
        /// Records that may wait for its thread.
        waiting: usize,
    },
    /// An event.
    Event(Event),
    /// The daemon.
    Info(Info),
    /// The status.
    Status(Status),
    /// The answer to a command.
    Answer(u64, Verdict),
}

/// From the process that publishes.
#[derive(Serialize, Deserialize, Debug)]
pub(super) enum FromPublisher {
    /// It publishes, or why it does not.
    Started(Result<(), PublishError>),
    /// Its thread makes progress; how many records it could not publish.
    Alive(u64),
    /// For the user.
    Text(String),
    /// From another program.
    Command(PendingCommand),
}

/// Two ends of a socket; neither waits.
///
/// # Errors
/// When the system has no more.
pub(super) fn pair() -> io::Result<(OwnedFd, OwnedFd)> {
    let flags = SockFlag::SOCK_CLOEXEC | SockFlag::SOCK_NONBLOCK;
    let ends = socketpair(AddressFamily::Unix, SockType::SeqPacket, None, flags)?;
    for end in [&ends.0, &ends.1] {
        setsockopt(end, sockopt::SndBuf, &WAITING_BYTES)?;
    }
    Ok(ends)
}

/// A message, encoded.
#[derive(Default, Debug)]
pub(super) struct Encoded {
    bytes: Vec<u8>,
    words: Vec<u64>,
}

impl Encoded {
    /// A record.
    pub(super) fn record<T: Schema>(&mut self, record: &T) -> &[u8] {
        self.words.resize(words::<T>(), 0);
        write_words(record, &mut self.words);
        self.bytes.clear();
        self.bytes.push(RECORD);
        self.bytes
            .extend(self.words.iter().flat_map(|word| word.to_ne_bytes()));
        &self.bytes
    }

    /// Another message.
    pub(super) fn other(&mut self, message: &impl Serialize) -> &[u8] {
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        bytes.push(OTHER);
        // Nothing that is sent cannot be encoded.
        self.bytes = postcard::to_extend(message, bytes).unwrap_or_default();
        &self.bytes
    }
}

/// Sends a message; whether there was room for it.
pub(super) fn put(socket: &impl AsFd, message: &[u8]) -> bool {
    let flags = MsgFlags::MSG_DONTWAIT | MsgFlags::MSG_NOSIGNAL;
    // An empty one would be taken for the end.
    !message.is_empty() && send(socket.as_fd().as_raw_fd(), message, flags).is_ok()
}

/// Room for a message.
pub(super) fn room() -> Vec<u8> {
    vec![0; MOST_BYTES]
}

/// A received message.
pub(super) enum Received<T> {
    /// A record, as words.
    Record(Vec<u64>),
    /// Another one.
    Other(T),
    /// Not a message: to be ignored.
    Invalid,
    /// There is none.
    Nothing,
    /// The other end is closed.
    Closed,
}

/// Takes the next message.
pub(super) fn take<T: DeserializeOwned>(socket: &impl AsFd, room: &mut [u8]) -> Received<T> {
    let received = recv(socket.as_fd().as_raw_fd(), room, MsgFlags::MSG_DONTWAIT);
    let length = match received {
        Ok(0) => return Received::Closed,
        Ok(length) => length,
        Err(Errno::EAGAIN | Errno::EINTR) => return Received::Nothing,
        Err(_) => return Received::Closed,
    };
    room.get(..length).map_or(Received::Invalid, read)
}

/// The message in these bytes: another program may have made the sender write
/// anything.
fn read<T: DeserializeOwned>(message: &[u8]) -> Received<T> {
    match message.split_first() {
        Some((&RECORD, bytes)) => {
            let words = bytes.chunks_exact(size_of::<u64>());
            let word = |bytes: &[u8]| bytes.try_into().map_or(0, u64::from_ne_bytes);
            Received::Record(words.map(word).collect())
        }
        Some((&OTHER, bytes)) => {
            postcard::from_bytes(bytes).map_or(Received::Invalid, Received::Other)
        }
        _ => Received::Invalid,
    }
}

/// Reads a message as the daemon does, and as the process that publishes does.
///
/// # Panics
/// When one that is read is sent as another one.
#[cfg(fuzzing)]
pub fn read_message(message: &[u8]) {
    fn read_again<T: DeserializeOwned + Serialize>(message: &[u8]) {
        let Received::Other(first) = read::<T>(message) else {
            return;
        };
        let (mut once, mut twice) = (Encoded::default(), Encoded::default());
        let Received::Other(second) = read::<T>(once.other(&first)) else {
            panic!("what was sent is not read");
        };
        assert_eq!(once.bytes, twice.other(&second));
    }
    read_again::<ToPublisher>(message);
    read_again::<FromPublisher>(message);
}
