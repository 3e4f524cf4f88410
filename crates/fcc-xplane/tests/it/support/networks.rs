//! Networks without sockets.

use std::collections::VecDeque;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex};

use fcc_xplane::{Errno, Port};

/// Supplies datagrams without a socket, all from one address; what is sent is
/// discarded.
pub struct Scripted {
    pub from: SocketAddr,
    pub datagrams: Mutex<VecDeque<Vec<u8>>>,
}

impl Port for Scripted {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        let next = self.datagrams.lock().unwrap().pop_front();
        Ok(next.map(|datagram| {
            let length = datagram.len().min(into.len());
            into[..length].copy_from_slice(&datagram[..length]);
            (length, self.from)
        }))
    }

    fn send(&self, _: &[u8], _: SocketAddr) -> Result<(), Errno> {
        Ok(())
    }
}

/// A datagram, and where it goes to or comes from.
pub type Addressed = (Vec<u8>, SocketAddr);

/// A network without sockets: what was sent, and what arrives, the last first.
#[derive(Clone, Default)]
pub struct Wire {
    pub sent: Arc<Mutex<Vec<Addressed>>>,
    pub arriving: Arc<Mutex<Vec<Addressed>>>,
}

impl Wire {
    pub fn arrives(&self, datagram: &[u8], from: SocketAddr) {
        self.arriving
            .lock()
            .unwrap()
            .push((datagram.to_vec(), from));
    }

    /// What was sent since the last call.
    pub fn take_sent(&self) -> Vec<Addressed> {
        std::mem::take(&mut self.sent.lock().unwrap())
    }
}

impl Port for Wire {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        let next = self.arriving.lock().unwrap().pop();
        Ok(next.map(|(datagram, from)| {
            into[..datagram.len()].copy_from_slice(&datagram);
            (datagram.len(), from)
        }))
    }

    fn send(&self, datagram: &[u8], to: SocketAddr) -> Result<(), Errno> {
        self.sent.lock().unwrap().push((datagram.to_vec(), to));
        Ok(())
    }
}
