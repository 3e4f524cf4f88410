//! Connects to a socket of another program, which may be stopped.

use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::Duration;

use nix::sys::socket::{
    AddressFamily, SockFlag, SockType, UnixAddr, connect, setsockopt, socket, sockopt,
};
use nix::sys::time::{TimeVal, TimeValLike};

/// Connects; while the queue of who listens is full, waits at most this long
/// (`SO_SNDTIMEO`, unix(7)); not at all if it is zero.
///
/// # Errors
/// `WouldBlock` if the queue is still full; any other if nobody listens there.
pub(super) fn connect_within(path: &Path, within: Duration) -> io::Result<UnixStream> {
    let flags = SockFlag::SOCK_CLOEXEC;
    let stream = socket(AddressFamily::Unix, SockType::Stream, flags, None)?;
    let stream = UnixStream::from(stream);
    if within.is_zero() {
        stream.set_nonblocking(true)?;
    } else {
        let within = TimeVal::milliseconds(within.as_millis() as i64);
        setsockopt(&stream, sockopt::SendTimeout, &within)?;
    }
    connect(stream.as_raw_fd(), &UnixAddr::new(path)?)?;
    Ok(stream)
}

#[cfg(test)]
mod tests {
    use std::io::ErrorKind;
    use std::os::unix::net::UnixListener;

    use super::*;

    #[test]
    fn who_does_not_accept_is_not_waited_for() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("socket");
        let error = connect_within(&path, Duration::ZERO).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::NotFound);
        let listener = UnixListener::bind(&path).unwrap();
        let mut waiting = Vec::new();
        let full = loop {
            match connect_within(&path, Duration::ZERO) {
                Ok(stream) => waiting.push(stream),
                Err(error) => break error.kind(),
            }
        };
        assert_eq!(full, ErrorKind::WouldBlock);
        let within = Duration::from_millis(10);
        let error = connect_within(&path, within).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::WouldBlock);
        listener.accept().unwrap();
        assert!(connect_within(&path, within).is_ok());
        drop(listener);
        let error = connect_within(&path, within).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::ConnectionRefused);
    }
}
