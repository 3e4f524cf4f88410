//! A servo board at the other end of a pseudo-terminal or of a socket.
#![allow(
    clippy::unwrap_used,
    unreachable_pub,
    dead_code,
    reason = "a test fails by panicking, and each test file uses its part"
)]

use std::fs::{File, remove_file};
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::thread::sleep;
use std::time::{Duration, Instant};

use fcc_core::flight::{Measurements, Surfaces as Outputs};
use fcc_core::framework::{Actuator, Sensor};
use fcc_servo_board::{
    Board, BoardConfig, Control, Decoder, Encoder, MAX_FRAME, MAX_MESSAGE, Readings, Surfaces,
};
use fcc_servo_link::{Baud, LineStatus, ServoBoardConfig, open_serial, open_udp};
use fcc_xplane::Simulator;
use nix::fcntl::{FcntlArg, OFlag, fcntl};
use nix::pty::openpty;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use nix::unistd::ttyname;
use tempfile::TempDir;

/// The way between a board and the devices under test.
pub trait Way: Send + Sized {
    fn open() -> (
        Self,
        Box<dyn Sensor<Measurements>>,
        Box<dyn Actuator<Outputs>>,
    );
    /// The messages that arrived at the board, and from where.
    fn received(&mut self) -> Vec<(SocketAddr, Vec<u8>)>;
    /// Sends a message of the board; returns once it is there.
    fn send(&mut self, to: SocketAddr, message: &[u8]);
    fn pull(&mut self);
    fn put_back(&mut self);
}

/// Until a condition is met that another thread brings about.
pub fn wait_until(what: &str, mut is_met: impl FnMut() -> bool) {
    let give_up = Instant::now() + Duration::from_secs(20);
    while !is_met() {
        assert!(Instant::now() < give_up, "{what}");
        sleep(Duration::from_micros(50));
    }
}

const NOBODY: SocketAddr = SocketAddr::new(std::net::IpAddr::V4(Ipv4Addr::LOCALHOST), 1);

/// A serial line: the path is a link to a pseudo-terminal, as `/dev/serial/by-id`
/// has them.
pub struct SerialLine {
    _folder: TempDir,
    pub path: PathBuf,
    pub master: Option<File>,
    pub decoder: Decoder,
    pub encoder: Encoder,
    pub status: LineStatus,
    /// What had been written and received when the line was last put back.
    written: u64,
    received: u64,
    frames: u64,
}

/// The board's end of a new line, to which the path leads from now on.
pub fn connect(path: &PathBuf) -> File {
    let pty = openpty(None, None).unwrap();
    let mut raw = tcgetattr(&pty.slave).unwrap();
    cfmakeraw(&mut raw);
    tcsetattr(&pty.slave, SetArg::TCSANOW, &raw).unwrap();
    fcntl(&pty.master, FcntlArg::F_SETFL(OFlag::O_NONBLOCK)).unwrap();
    let _ = remove_file(path);
    symlink(ttyname(&pty.slave).unwrap(), path).unwrap();
    // The slave is closed here, and opened by whoever uses the path.
    File::from(pty.master)
}

impl SerialLine {
    pub fn write(&mut self, bytes: &[u8]) {
        if let Some(master) = &mut self.master {
            master.write_all(bytes).unwrap();
        }
    }

    pub fn frame(&mut self, message: &[u8]) -> Vec<u8> {
        let mut frame = [0; MAX_FRAME];
        self.encoder.frame(message, &mut frame).unwrap().to_vec()
    }
}

impl Way for SerialLine {
    fn open() -> (
        Self,
        Box<dyn Sensor<Measurements>>,
        Box<dyn Actuator<Outputs>>,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ttyBOARD");
        let master = connect(&path);
        let config = ServoBoardConfig::default();
        let (sensor, actuator, status) = open_serial(&config, &path, Baud::B115200).unwrap();
        let line = Self {
            _folder: folder,
            path,
            master: Some(master),
            decoder: Decoder::new(),
            encoder: Encoder::new(),
            status,
            written: 0,
            received: 0,
            frames: 0,
        };
        (line, Box::new(sensor), Box::new(actuator))
    }

    fn received(&mut self) -> Vec<(SocketAddr, Vec<u8>)> {
        let status = self.status.clone();
        wait_until("what is sent is written or dropped", || {
            status.sent() == status.written() + status.dropped()
        });
        let mut messages = Vec::new();
        let Some(master) = &mut self.master else {
            return Vec::new();
        };
        let (decoder, written) = (&mut self.decoder, status.written() - self.written);
        wait_until("what is written arrives", || {
            let mut bytes = [0; 4_096];
            match master.read(&mut bytes) {
                Ok(length) => {
                    for byte in &bytes[..length] {
                        messages.extend(decoder.push(*byte).map(<[u8]>::to_vec));
                    }
                }
                Err(error) => assert_eq!(error.kind(), ErrorKind::WouldBlock),
            }
            u64::from(decoder.counts().received) >= written
        });
        let each = messages.into_iter().map(|message| (NOBODY, message));
        each.collect()
    }

    fn send(&mut self, _: SocketAddr, message: &[u8]) {
        if self.master.is_none() {
            return;
        }
        let frame = self.frame(message);
        self.write(&frame);
        self.frames += 1;
        wait_until("a frame is received", || {
            self.status.received() - self.received >= self.frames
        });
    }

    fn pull(&mut self) {
        self.master = None;
        wait_until("the loss is noticed", || !self.status.is_open());
    }

    fn put_back(&mut self) {
        self.decoder = Decoder::new();
        self.frames = 0;
        self.written = self.status.written();
        self.received = self.status.received();
        self.master = Some(connect(&self.path));
        wait_until("the line is opened again", || self.status.is_open());
    }
}

/// Wi-Fi; what is sent arrives before `send` returns.
pub struct Udp {
    socket: UdpSocket,
    is_there: bool,
}

impl Way for Udp {
    fn open() -> (
        Self,
        Box<dyn Sensor<Measurements>>,
        Box<dyn Actuator<Outputs>>,
    ) {
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.set_nonblocking(true).unwrap();
        let board = Simulator::At(socket.local_addr().unwrap());
        let (sensor, actuator) = open_udp(&ServoBoardConfig::default(), &board).unwrap();
        let udp = Self {
            socket,
            is_there: true,
        };
        (udp, Box::new(sensor), Box::new(actuator))
    }

    fn received(&mut self) -> Vec<(SocketAddr, Vec<u8>)> {
        let mut messages = Vec::new();
        let mut bytes = [0; 2_048];
        while let Ok((length, from)) = self.socket.recv_from(&mut bytes) {
            messages.push((from, bytes[..length].to_vec()));
        }
        messages.retain(|_| self.is_there);
        messages
    }

    fn send(&mut self, to: SocketAddr, message: &[u8]) {
        if self.is_there {
            self.socket.send_to(message, to).unwrap();
        }
    }

    /// Out of range.
    fn pull(&mut self) {
        self.received();
        self.is_there = false;
    }

    fn put_back(&mut self) {
        self.received();
        self.is_there = true;
    }
}

/// A board, the way to it, and the devices under test.
pub struct Bench<W: Way> {
    pub way: W,
    pub board: Board<SocketAddr>,
    pub sensor: Box<dyn Sensor<Measurements>>,
    pub actuator: Box<dyn Actuator<Outputs>>,
    pub measured: Measurements,
    pub readings: Readings,
    pub now_ms: u32,
    pub messages: u64,
}

impl<W: Way> Bench<W> {
    pub fn open() -> Self {
        let (way, sensor, actuator) = W::open();
        Self {
            way,
            board: Board::new(BoardConfig::default()),
            sensor,
            actuator,
            measured: Measurements::default(),
            readings: Readings {
                airspeed_mps: Some(30.0),
                differential_pressure_pa: Some(551.25),
                engage_switch: Some(true),
                pilot: Some(Surfaces {
                    elevator: 0.125,
                    aileron: -0.25,
                    rudder: 0.5,
                    throttle: 0.75,
                }),
            },
            now_ms: 0,
            messages: 0,
        }
    }

    pub fn receive(&mut self) {
        for (from, message) in self.way.received() {
            self.messages += 1;
            let _ = self.board.receive(self.now_ms, from, &message);
        }
    }

    /// A tick of the board.
    pub fn live(&mut self) {
        self.now_ms += 25;
        self.receive();
        let mut message = [0; MAX_MESSAGE];
        let reply = self.board.poll(self.now_ms, &self.readings, &mut message);
        if let Some((reply, to)) = reply.zip(self.board.peer()) {
            self.way.send(to, reply);
        }
    }

    pub fn is_held(&mut self) -> bool {
        self.receive();
        self.board.control() != Control::Free
    }

    pub fn follows(&mut self, outputs: &Outputs) -> bool {
        self.receive();
        let drive = self.board.drive();
        let [elevator, aileron, rudder, throttle] = [
            outputs.elevator,
            outputs.aileron,
            outputs.rudder,
            outputs.throttle,
        ]
        .map(|value| value as f32);
        let same = |driven: Option<f32>, given: Option<f64>| {
            given.is_none_or(|given| driven == Some(given as f32))
        };
        let [left, right] = [0, 1].map(|wheel| drive.brakes.map(|brakes| brakes[wheel]));
        drive.surfaces == Some([elevator, aileron, rudder])
            && drive.throttle == Some(throttle)
            && same(drive.flaps, outputs.flaps)
            && same(left, outputs.left_brake)
            && same(right, outputs.right_brake)
            && same(drive.gear, outputs.gear)
    }
}
