//! The thread that serves a serial line: frames on the line, messages on a
//! socket.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::os::fd::{AsFd as _, AsRawFd as _, OwnedFd};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use fcc_servo_board::{Decoder, Encoder, MAX_FRAME};
use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use nix::sys::socket::{MsgFlags, recv, send};
use nix::sys::termios::{FlushArg, tcflush};

use crate::line::Line;
use crate::tty::{self, Baud};

/// The interval between two attempts to open a line that was lost.
const OPEN_EVERY: Duration = Duration::from_millis(100);
/// A line that takes nothing for this long takes nothing any more.
const STUCK_AFTER: Duration = Duration::from_secs(1);
/// What is read in this time: 1,000,000 bytes a second, ten times what the fastest line
/// carries, with ten bits a byte. A device at USB keeps no rate of a line.
const MOST_BYTES: usize = 100_000;
const COUNTED_IN: Duration = Duration::from_millis(100);
/// Longer than any message.
const MESSAGE_BYTES: usize = 1_024;
const READ_BYTES: usize = 1_024;

/// Why the line is no longer served.
enum End {
    /// The loop has ended.
    Loop,
    /// The line is lost.
    Line(Errno),
}

pub(crate) struct Relay {
    path: PathBuf,
    baud: Baud,
    socket: OwnedFd,
    line: Arc<Line>,
    decoder: Decoder,
    encoder: Encoder,
    /// What is still to be written of a frame.
    pending: Vec<u8>,
    pending_since: Instant,
    /// Since when what is read is counted, and how much it is.
    counted_since: Instant,
    bytes: usize,
}

impl Relay {
    pub(crate) fn new(path: &Path, baud: Baud, socket: OwnedFd, line: Arc<Line>) -> Self {
        Self {
            path: path.to_owned(),
            baud,
            socket,
            line,
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            pending: Vec::with_capacity(MAX_FRAME),
            pending_since: Instant::now(),
            counted_since: Instant::now(),
            bytes: 0,
        }
    }

    /// Until the loop's end is closed.
    pub(crate) fn run(mut self, mut tty: File) {
        loop {
            let errno = match self.serve(&mut tty) {
                End::Loop => return,
                End::Line(errno) => errno,
            };
            self.line.errno.store(errno as i32, Ordering::Relaxed);
            drop(tty);
            self.decoder.reset();
            if !self.pending.is_empty() {
                self.pending.clear();
                self.line.dropped.fetch_add(1, Ordering::Release);
            }
            tty = loop {
                match self.discard() {
                    Some(End::Loop) => return,
                    Some(End::Line(_)) | None => {}
                }
                match tty::open(&self.path, self.baud) {
                    Ok(tty) => break tty,
                    Err(error) => {
                        let errno = error.raw_os_error().unwrap_or(Errno::EBUSY as i32);
                        self.line.errno.store(errno, Ordering::Relaxed);
                    }
                }
            };
            self.line.errno.store(0, Ordering::Relaxed);
        }
    }

    /// Carries messages both ways.
    fn serve(&mut self, tty: &mut File) -> End {
        loop {
            self.count_anew(tty);
            let writes = !self.pending.is_empty();
            let (line, messages) = match self.wait(tty, writes) {
                Ok(ready) => ready,
                Err(errno) => return End::Line(errno),
            };
            let ended = if line.intersects(PollFlags::POLLIN) {
                self.read(tty)
            } else if line.intersects(PollFlags::POLLHUP | PollFlags::POLLERR | PollFlags::POLLNVAL)
            {
                Some(End::Line(Errno::EIO))
            } else {
                None
            };
            let ended = ended.or_else(|| {
                if writes {
                    self.write(tty)
                } else if messages.intersects(PollFlags::POLLIN | PollFlags::POLLHUP) {
                    self.fetch().or_else(|| self.write(tty))
                } else {
                    None
                }
            });
            if let Some(end) = ended {
                return end;
            }
        }
    }

    /// Begins to count what is read anew, if it is time. What has arrived while a
    /// flood was not read is old, and dropped.
    fn count_anew(&mut self, tty: &File) {
        if self.counted_since.elapsed() < COUNTED_IN {
            return;
        }
        if self.is_flooded() {
            let _ = tcflush(tty, FlushArg::TCIFLUSH);
            self.decoder.reset();
            self.line.floods.fetch_add(1, Ordering::Release);
        }
        self.counted_since = Instant::now();
        self.bytes = 0;
    }

    /// More has arrived than any board sends: nothing is read until it is counted anew.
    const fn is_flooded(&self) -> bool {
        self.bytes > MOST_BYTES
    }

    /// What is ready: the line and, unless something is pending, the loop's
    /// messages. Of a flood none is waited for.
    fn wait(&self, tty: &File, writes: bool) -> Result<(PollFlags, PollFlags), Errno> {
        let nothing = PollFlags::empty();
        let out = if writes { PollFlags::POLLOUT } else { nothing };
        let (input, flood_ends) = if self.is_flooded() {
            (nothing, Some(COUNTED_IN))
        } else {
            (PollFlags::POLLIN, None)
        };
        let mut fds = [
            PollFd::new(tty.as_fd(), input | out),
            PollFd::new(self.socket.as_fd(), PollFlags::POLLIN),
        ];
        let (asked, stuck) = if writes {
            (fds.get_mut(..1).unwrap_or_default(), Some(STUCK_AFTER))
        } else {
            (fds.as_mut_slice(), None)
        };
        let timeout = flood_ends.or(stuck).map_or(PollTimeout::NONE, |timeout| {
            PollTimeout::try_from(timeout).unwrap_or(PollTimeout::MAX)
        });
        match poll(asked, timeout) {
            Ok(_) => {
                let [line, messages] = fds.map(|fd| fd.revents().unwrap_or(nothing));
                Ok((line, messages))
            }
            Err(Errno::EINTR) => Ok((nothing, nothing)),
            Err(errno) => Err(errno),
        }
    }

    /// From the line to the loop.
    fn read(&mut self, tty: &mut File) -> Option<End> {
        let mut bytes = [0; READ_BYTES];
        let length = match tty.read(&mut bytes) {
            Ok(0) => return Some(End::Line(Errno::EIO)),
            Ok(length) => length,
            Err(error) => return lost(&error),
        };
        self.bytes += length;
        for byte in bytes.get(..length).unwrap_or_default() {
            if let Some(message) = self.decoder.push(*byte) {
                // If the loop does not read, the newest are dropped.
                let flags = MsgFlags::MSG_DONTWAIT | MsgFlags::MSG_NOSIGNAL;
                let _ = send(self.socket.as_raw_fd(), message, flags);
            }
        }
        let counts = self.decoder.counts();
        let each = [
            (&self.line.received, counts.received),
            (&self.line.corrupt, counts.corrupt),
            (&self.line.lost, counts.lost),
        ];
        for (shown, count) in each {
            shown.store(count.into(), Ordering::Release);
        }
        None
    }

    /// The next message of the loop, as a frame to be written.
    fn fetch(&mut self) -> Option<End> {
        let mut message = [0; MESSAGE_BYTES];
        let received = recv(
            self.socket.as_raw_fd(),
            &mut message,
            MsgFlags::MSG_DONTWAIT,
        );
        match received {
            Ok(0) => Some(End::Loop),
            Ok(length) => {
                let mut frame = [0; MAX_FRAME];
                let message = message.get(..length).unwrap_or_default();
                if let Some(bytes) = self.encoder.frame(message, &mut frame) {
                    self.pending.extend_from_slice(bytes);
                    self.pending_since = Instant::now();
                } else {
                    self.line.dropped.fetch_add(1, Ordering::Release);
                }
                None
            }
            Err(Errno::EAGAIN | Errno::EINTR) => None,
            Err(_) => Some(End::Loop),
        }
    }

    /// What is pending, as far as the line takes it.
    fn write(&mut self, tty: &mut File) -> Option<End> {
        if self.pending.is_empty() {
            return None;
        }
        match tty.write(&self.pending) {
            Ok(length) => {
                self.pending.drain(..length);
                if self.pending.is_empty() {
                    self.line.written.fetch_add(1, Ordering::Release);
                }
                None
            }
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => {
                let is_stuck = self.pending_since.elapsed() >= STUCK_AFTER;
                is_stuck.then_some(End::Line(Errno::EAGAIN))
            }
            Err(error) => lost(&error),
        }
    }

    /// Waits until the line is tried again, and drops what was to be written: it
    /// would be old.
    fn discard(&mut self) -> Option<End> {
        let until = Instant::now() + OPEN_EVERY;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            let mut fds = [PollFd::new(self.socket.as_fd(), PollFlags::POLLIN)];
            let timeout = PollTimeout::try_from(left).unwrap_or(PollTimeout::ZERO);
            if poll(&mut fds, timeout) == Ok(0) {
                return None;
            }
            if let Some(end) = self.fetch() {
                return Some(end);
            }
            if !self.pending.is_empty() {
                self.pending.clear();
                self.line.dropped.fetch_add(1, Ordering::Release);
            }
        }
    }
}

/// Whether an error is the end of the line.
fn lost(error: &io::Error) -> Option<End> {
    match error.kind() {
        io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted => None,
        _ => {
            let errno = error.raw_os_error().map_or(Errno::EIO, Errno::from_raw);
            Some(End::Line(errno))
        }
    }
}
