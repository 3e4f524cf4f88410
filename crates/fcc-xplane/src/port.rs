//! What datagrams are sent and received by.

use std::net::SocketAddr;

/// An operating system's error number, 0 if it gave none.
pub type Errno = i32;

/// Sends and receives datagrams without ever waiting. [`UdpPort`](crate::UdpPort)
/// is the implementation for UDP; tests and fuzzing have others.
pub trait Port: Send + Sync {
    /// Receives the next datagram: its length and sender; `None` if there is
    /// none now. Bytes that do not fit the buffer are cut off.
    ///
    /// # Errors
    /// The operating system's error number.
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno>;

    /// Sends a datagram, or fails at once.
    ///
    /// # Errors
    /// The operating system's error number.
    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno>;

    /// Sends contiguous datagrams of `size` bytes, every one even if another
    /// fails.
    ///
    /// # Errors
    /// The first failure's error number.
    fn send_each(&self, datagrams: &[u8], size: usize, to: SocketAddr) -> Result<(), Errno> {
        send_one_by_one(self, datagrams, size, to)
    }

    /// Loads the code and data of [`receive`](Self::receive) into the caches.
    /// Takes no datagram. Does nothing by default.
    fn warm_up_receive(&self) {}

    /// Loads the code and data of [`send_each`](Self::send_each) into the
    /// caches. Sends nothing. Does nothing by default.
    fn warm_up_send(&self, _datagrams: &[u8], _size: usize) {}
}

pub(crate) fn send_one_by_one<P: Port + ?Sized>(
    port: &P,
    datagrams: &[u8],
    size: usize,
    to: SocketAddr,
) -> Result<(), Errno> {
    let mut outcome = Ok(());
    for datagram in datagrams.chunks(size.max(1)) {
        outcome = outcome.and(port.send(datagram, to));
    }
    outcome
}
