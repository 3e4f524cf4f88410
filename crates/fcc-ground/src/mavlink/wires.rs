//! The sockets and lines of links: whose bytes are read, and where bytes go.
//!
//! Nothing here waits. What a peer sends too much is left to the system, which drops it.

use core::mem::replace;
use std::collections::BTreeMap;
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::net::{IpAddr, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use fcc_linux::serial::{LineSettings, SerialLine};
use fcc_mavlink::{LinkId, LinkOptions};

use super::address::{MavlinkLink, Way, own};

/// Peers of a listening link. One from which nothing valid has come makes room for others.
const MOST_PEERS: usize = 8;
/// A peer that says nothing for so long is forgotten.
const SILENT: Duration = Duration::from_secs(30);
/// Datagrams of a socket that are read in one round.
const MOST_READ: usize = 64;
/// Frames that wait for a line.
const MOST_QUEUED: usize = 32;
/// A line that has failed is opened again after this time.
const AGAIN_AFTER: Duration = Duration::from_secs(2);
const BUFFER_BYTES: usize = 2_048;

/// What has happened on the links.
#[derive(Debug)]
pub(super) enum Heard {
    Opened(LinkId, LinkOptions),
    Bytes(LinkId, Vec<u8>),
    Closed(LinkId),
}

#[derive(Debug)]
enum Wire {
    Udp(Arc<UdpSocket>, SocketAddr),
    Tcp(TcpStream),
    Serial(SyncSender<Vec<u8>>, Receiver<Vec<u8>>),
}

/// Who listens, and what its links are.
#[derive(Debug)]
enum Listener {
    Udp(Arc<UdpSocket>, LinkOptions),
    Tcp(TcpListener, LinkOptions),
}

#[derive(Debug)]
struct Peer {
    wire: Wire,
    /// How the link is called in recordings.
    name: String,
    /// When it was heard, if it may be forgotten.
    heard: Option<Instant>,
    /// At which listener.
    listener: Option<usize>,
    /// A frame of it was read, signed if there is a key.
    is_known: bool,
}

/// All links.
#[derive(Debug)]
pub(super) struct Wires {
    peers: BTreeMap<LinkId, Peer>,
    listeners: Vec<Listener>,
    /// Who may speak to listening links, besides this machine.
    allowed: Vec<IpAddr>,
    next: LinkId,
}

impl Wires {
    /// Opens all links; returns those that are there from the beginning, too.
    pub(super) fn open(
        links: &[MavlinkLink],
        allowed: &[IpAddr],
    ) -> io::Result<(Self, Vec<Heard>)> {
        let mut wires = Self {
            peers: BTreeMap::new(),
            listeners: Vec::new(),
            allowed: allowed.to_vec(),
            next: 0,
        };
        let mut heard = Vec::new();
        for link in links {
            wires.open_one(link, &mut heard).map_err(|error| {
                let at = format!("{}: {error}: choose another one", link.way);
                io::Error::new(error.kind(), at)
            })?;
        }
        Ok((wires, heard))
    }

    fn open_one(&mut self, link: &MavlinkLink, heard: &mut Vec<Heard>) -> io::Result<()> {
        let options = link.options;
        match &link.way {
            Way::UdpTo(to) => {
                let socket = UdpSocket::bind(own(*to))?;
                socket.set_nonblocking(true)?;
                let wire = Wire::Udp(Arc::new(socket), *to);
                self.add(wire, to.to_string(), options, None, heard);
            }
            Way::UdpIn(at) => {
                let socket = UdpSocket::bind(at)?;
                socket.set_nonblocking(true)?;
                self.listeners
                    .push(Listener::Udp(Arc::new(socket), options));
            }
            Way::TcpIn(at) => {
                let listener = TcpListener::bind(at)?;
                listener.set_nonblocking(true)?;
                self.listeners.push(Listener::Tcp(listener, options));
            }
            Way::Serial(device, baud) => {
                let settings = LineSettings {
                    path: device.clone(),
                    baud: *baud,
                    has_even_parity: false,
                };
                let wire = serial(settings)?;
                self.add(wire, device.display().to_string(), options, None, heard);
            }
        }
        Ok(())
    }

    fn add(
        &mut self,
        wire: Wire,
        name: String,
        options: LinkOptions,
        listener: Option<usize>,
        heard: &mut Vec<Heard>,
    ) -> Option<LinkId> {
        let others = self.peers.iter();
        let others = others.filter(|(_, peer)| listener.is_some() && peer.listener == listener);
        if others.clone().count() >= MOST_PEERS {
            let unknown = others.filter(|(_, peer)| !peer.is_known);
            let (oldest, _) = unknown.min_by_key(|(_, peer)| peer.heard)?;
            let oldest = *oldest;
            self.peers.remove(&oldest);
            heard.push(Heard::Closed(oldest));
        }
        self.next = self.next.wrapping_add(1);
        let peer = Peer {
            wire,
            name,
            heard: listener.map(|_| Instant::now()),
            listener,
            is_known: false,
        };
        self.peers.insert(self.next, peer);
        heard.push(Heard::Opened(self.next, options));
        Some(self.next)
    }

    /// A frame was read of what came by a link.
    pub(super) fn know(&mut self, link: LinkId) {
        if let Some(peer) = self.peers.get_mut(&link) {
            peer.is_known = true;
        }
    }

    /// How a link is called.
    pub(super) fn name(&self, link: LinkId) -> &str {
        self.peers.get(&link).map_or("", |peer| &peer.name)
    }

    /// What has arrived since the last time.
    pub(super) fn read(&mut self) -> Vec<Heard> {
        let mut heard = self.listen();
        let mut buffer = [0; BUFFER_BYTES];
        let mut closed = Vec::new();
        for (link, peer) in &mut self.peers {
            let is_silent = peer.heard.is_some_and(|heard| heard.elapsed() > SILENT);
            match peer.wire.read(&mut buffer, |bytes| {
                heard.push(Heard::Bytes(*link, bytes.to_vec()));
            }) {
                Ok(true) => peer.heard = peer.heard.map(|_| Instant::now()),
                Ok(false) if is_silent => closed.push(*link),
                Ok(false) => {}
                Err(_) => closed.push(*link),
            }
        }
        for link in closed {
            self.peers.remove(&link);
            heard.push(Heard::Closed(link));
        }
        heard
    }

    /// What has arrived at listening sockets.
    fn listen(&mut self) -> Vec<Heard> {
        let mut heard = Vec::new();
        let mut buffer = [0; BUFFER_BYTES];
        for listener in 0..self.listeners.len() {
            for _ in 0..MOST_READ {
                match self.listeners.get(listener) {
                    Some(Listener::Udp(socket, options)) => {
                        let (socket, options) = (Arc::clone(socket), *options);
                        let Ok((length, from)) = socket.recv_from(&mut buffer) else {
                            break;
                        };
                        if !self.permits(from) {
                            continue;
                        }
                        let link = self.udp_peer(from).or_else(|| {
                            let wire = Wire::Udp(socket, from);
                            self.add(wire, from.to_string(), options, Some(listener), &mut heard)
                        });
                        if let Some((link, bytes)) = link.zip(buffer.get(..length)) {
                            heard.push(Heard::Bytes(link, bytes.to_vec()));
                        }
                    }
                    Some(Listener::Tcp(socket, options)) => {
                        let (Ok((stream, from)), options) = (socket.accept(), *options) else {
                            break;
                        };
                        if self.permits(from) && stream.set_nonblocking(true).is_ok() {
                            // Small frames are not to wait for each other.
                            let _ = stream.set_nodelay(true);
                            let wire = Wire::Tcp(stream);
                            let name = from.to_string();
                            self.add(wire, name, options, Some(listener), &mut heard);
                        }
                    }
                    None => break,
                }
            }
        }
        heard
    }

    fn permits(&self, from: SocketAddr) -> bool {
        let ip = from.ip().to_canonical();
        ip.is_loopback() || self.allowed.contains(&ip)
    }

    /// The link of a peer that was heard before, which is heard again.
    fn udp_peer(&mut self, from: SocketAddr) -> Option<LinkId> {
        let mut peers = self.peers.iter_mut();
        let (link, peer) = peers.find(|(_, peer)| {
            peer.heard.is_some() && matches!(&peer.wire, Wire::Udp(_, to) if *to == from)
        })?;
        peer.heard = Some(Instant::now());
        Some(*link)
    }

    /// Sends a frame; one that cannot be sent now is lost, as on the way.
    pub(super) fn write(&mut self, link: LinkId, frame: Vec<u8>) {
        let Some(peer) = self.peers.get_mut(&link) else {
            return;
        };
        match &mut peer.wire {
            Wire::Udp(socket, to) => drop(socket.send_to(&frame, *to)),
            Wire::Tcp(stream) => match stream.write(&frame) {
                Ok(length) if length == frame.len() => {}
                Err(error) if error.kind() == ErrorKind::WouldBlock => {}
                // In the middle of a frame: the station connects again.
                _ => drop(stream.shutdown(std::net::Shutdown::Both)),
            },
            Wire::Serial(to, _) => drop(to.try_send(frame)),
        }
    }
}

impl Wire {
    /// Reads what is there; whether there was anything. An error is its end.
    fn read(&mut self, buffer: &mut [u8], mut take: impl FnMut(&[u8])) -> io::Result<bool> {
        let mut is_heard = false;
        for _ in 0..MOST_READ {
            let length = match self {
                Self::Udp(socket, to) => match socket.recv_from(buffer) {
                    Ok((length, from)) if from == *to => length,
                    // Whoever else knows the port is not heard.
                    Ok(_) => continue,
                    // Nobody listens there yet.
                    Err(_) => return Ok(is_heard),
                },
                Self::Tcp(stream) => match stream.read(buffer) {
                    Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                    Ok(length) => length,
                    Err(error) if error.kind() == ErrorKind::WouldBlock => return Ok(is_heard),
                    Err(error) => return Err(error),
                },
                Self::Serial(_, from) => {
                    let Ok(bytes) = from.try_recv() else {
                        return Ok(is_heard);
                    };
                    take(&bytes);
                    is_heard = true;
                    continue;
                }
            };
            take(buffer.get(..length).unwrap_or_default());
            is_heard = true;
        }
        Ok(is_heard)
    }
}

/// A line, in a thread of its own, which opens it again whenever it is unplugged.
fn serial(settings: LineSettings) -> io::Result<Wire> {
    let (to_line, to_write) = sync_channel::<Vec<u8>>(MOST_QUEUED);
    let (read, from_line) = sync_channel(MOST_QUEUED);
    thread::Builder::new()
        .name("ground-mav-line".to_owned())
        .spawn(move || {
            let mut buffer = [0; BUFFER_BYTES];
            let mut said = false;
            loop {
                let mut line = match SerialLine::open(&settings) {
                    Ok(line) => line,
                    Err(error) => {
                        if !replace(&mut said, true) {
                            let text = format!("fcc-ground: --mavlink: {error}; tried again");
                            let _ = writeln!(io::stderr(), "{text}");
                        }
                        thread::sleep(AGAIN_AFTER);
                        match to_write.try_recv() {
                            Err(std::sync::mpsc::TryRecvError::Disconnected) => return,
                            _ => continue,
                        }
                    }
                };
                said = false;
                while let Ok(length) = line.read(&mut buffer) {
                    let bytes = buffer.get(..length).unwrap_or_default();
                    if length > 0 {
                        // What is too much for the protocol is lost.
                        let _ = read.try_send(bytes.to_vec());
                    }
                    loop {
                        match to_write.try_recv() {
                            Ok(frame) => drop(line.write(&frame)),
                            Err(std::sync::mpsc::TryRecvError::Empty) => break,
                            Err(std::sync::mpsc::TryRecvError::Disconnected) => return,
                        }
                    }
                }
            }
        })?;
    Ok(Wire::Serial(to_line, from_line))
}
