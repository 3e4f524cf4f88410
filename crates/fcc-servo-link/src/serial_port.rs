//! A serial line as a port for messages, for the loop.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::os::fd::{AsRawFd as _, OwnedFd};
use std::path::Path;
use std::sync::mpsc::{Receiver, sync_channel};
use std::sync::{Arc, Mutex};
use std::thread;

use fcc_timer::RealtimeRequest;
use fcc_xplane::{Errno, Port};
use nix::sys::socket::sockopt::SndBuf;
use nix::sys::socket::{
    AddressFamily, MsgFlags, Shutdown, SockFlag, SockType, recv, send, setsockopt, shutdown,
    socketpair,
};

use crate::line::{Line, LineStatus};
use crate::relay::Relay;
use crate::tty::{self, Baud};

/// The other end of the line, for an adapter that knows addresses.
pub(crate) const BOARD: SocketAddr =
    SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 49_000);
/// What waits for the line, with the kernel's own share of about 700 bytes a
/// message: a release and a portion of requests fit, and no second of surfaces.
const QUEUE_BYTES: usize = 16_384;
/// How long the end waits for the last messages, a release, to be written.
const END_WITHIN: Duration = Duration::from_secs(1);

/// A serial line: each message is a frame.
#[derive(Debug)]
pub struct SerialPort {
    socket: OwnedFd,
    line: Arc<Line>,
    /// Closed by the thread at its end.
    ended: Mutex<Receiver<()>>,
}

impl SerialPort {
    /// Opens the line, and starts the thread that serves it, with a real-time
    /// priority if one is given and granted.
    ///
    /// # Errors
    /// When the line cannot be opened, another program has it, or there are no
    /// resources for the thread.
    pub fn open(path: &Path, baud: Baud, priority: Option<u8>) -> io::Result<Self> {
        let tty = tty::open(path, baud)?;
        let flags = SockFlag::SOCK_NONBLOCK | SockFlag::SOCK_CLOEXEC;
        let (socket, other) = socketpair(AddressFamily::Unix, SockType::SeqPacket, None, flags)?;
        setsockopt(&socket, SndBuf, &QUEUE_BYTES)?;
        let line = Arc::new(Line::default());
        let (end, ended) = sync_channel(0);
        let relay = Relay::new(path, baud, other, Arc::clone(&line));
        thread::Builder::new()
            .name("servo-line".to_owned())
            .spawn(move || {
                // That it is denied is reported for the loop.
                let _granted = RealtimeRequest {
                    priority,
                    ..RealtimeRequest::default()
                }
                .apply();
                relay.run(tty);
                drop(end);
            })?;
        Ok(Self {
            socket,
            line,
            ended: Mutex::new(ended),
        })
    }

    /// The line's state.
    pub fn status(&self) -> LineStatus {
        LineStatus(Arc::clone(&self.line))
    }
}

impl Port for SerialPort {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        match recv(self.socket.as_raw_fd(), into, MsgFlags::MSG_DONTWAIT) {
            // The thread has ended.
            Ok(0) => Err(libc_errno(nix::errno::Errno::EPIPE)),
            Ok(length) => Ok(Some((length, BOARD))),
            Err(nix::errno::Errno::EAGAIN) => self.line.lost().map(|()| None),
            Err(errno) => Err(libc_errno(errno)),
        }
    }

    fn send(&self, message: &[u8], _: SocketAddr) -> Result<(), Errno> {
        self.line.lost()?;
        let flags = MsgFlags::MSG_DONTWAIT | MsgFlags::MSG_NOSIGNAL;
        let message = fcc_servo_board::shortened(message);
        // Counted before, so that what was written is never more than what was sent.
        self.line.sent.fetch_add(1, Ordering::Release);
        send(self.socket.as_raw_fd(), message, flags).map_or_else(
            |errno| {
                self.line.sent.fetch_sub(1, Ordering::Release);
                Err(libc_errno(errno))
            },
            |_| Ok(()),
        )
    }
}

const fn libc_errno(errno: nix::errno::Errno) -> Errno {
    errno as Errno
}

impl Drop for SerialPort {
    /// Waits until the last messages are written, a second at most.
    fn drop(&mut self) {
        let _ = shutdown(self.socket.as_raw_fd(), Shutdown::Write);
        if let Ok(ended) = self.ended.get_mut() {
            let _ = ended.recv_timeout(END_WITHIN);
        }
    }
}
