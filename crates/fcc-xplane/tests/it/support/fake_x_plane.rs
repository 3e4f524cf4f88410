//! A minimal X-Plane on a loopback socket, written from the layouts and not with
//! the crate's own builders.

use std::collections::HashMap;
use std::net::{SocketAddr, SocketAddrV4, UdpSocket};

use fcc_xplane::{Simulator, XPlaneConfig};

use super::{
    FLIGHT_TIME, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, P, PAUSED, SWITCH, THROTTLE, YOKE_HEADING,
    YOKE_PITCH, YOKE_ROLL, position_reply,
};

/// A minimal X-Plane: stores requests and writes, and sends frames when the
/// test calls for them.
pub struct FakeXPlane {
    /// Listens.
    pub socket: UdpSocket,
    /// Sends, from another port, as X-Plane does.
    pub sender: UdpSocket,
    /// The last requester.
    pub client: Option<SocketAddr>,
    /// Index -> path.
    pub subscribed: HashMap<i32, String>,
    /// The number of requests of every kind.
    pub requests: usize,
    pub position_hz: Option<String>,
    /// Longitude, latitude (deg), elevation (m).
    pub position: [f64; 3],
    pub values: HashMap<String, f32>,
    /// Every write in its order.
    pub writes: Vec<(String, f32)>,
    /// Whether writes take effect; off simulates a firewall.
    pub accepts_writes: bool,
}

impl FakeXPlane {
    pub fn new() -> Self {
        Self::at("127.0.0.1:0")
    }

    pub fn at(address: &str) -> Self {
        let socket = UdpSocket::bind(address).unwrap();
        socket.set_nonblocking(true).unwrap();
        let ip = socket.local_addr().unwrap().ip();
        let sender = UdpSocket::bind((ip, 0)).unwrap();
        let mut values: HashMap<String, f32> = [
            (PAUSED, 0.0),
            (FLIGHT_TIME, 100.0),
            ("sim/time/framerate_period", 0.02),
            ("sim/time/is_in_replay", 0.0),
            (SWITCH, 0.0),
            (OVERRIDE_JOYSTICK, 0.0),
            (OVERRIDE_THROTTLES, 0.0),
            (YOKE_PITCH, 0.0),
            (YOKE_ROLL, 0.0),
            (YOKE_HEADING, 0.0),
            (THROTTLE, 0.65),
            ("sim/flightmodel2/position/pressure_altitude", 3_000.0),
            // Set to 29.5 inHg: 392 ft less (FAA-H-8083-25C, figure 11-3).
            ("sim/cockpit2/gauges/indicators/altitude_ft_pilot", 2_608.0),
            (
                "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot",
                29.5,
            ),
            ("sim/flightmodel/failures/onground_any", 0.0),
            ("sim/version/xplane_internal_version", 115_501.0),
        ]
        .map(|(path, value)| (path.to_owned(), value))
        .into();
        for (name, value) in [
            ("theta", 2.5),
            ("phi", -20.0),
            ("psi", 275.0),
            ("mag_psi", 270.0),
            ("Prad", 0.01),
            ("Qrad", -0.02),
            ("Rrad", 0.03),
            ("local_ax", 0.0),
            ("local_ay", 0.0),
            ("local_az", 0.0),
            ("local_vx", -50.0),
            ("local_vy", 1.0),
            ("local_vz", 4.0),
            ("indicated_airspeed", 100.0),
            ("alpha", 3.0),
        ] {
            values.insert(format!("{P}{name}"), value);
        }
        Self {
            socket,
            sender,
            client: None,
            subscribed: HashMap::new(),
            requests: 0,
            position_hz: None,
            position: [8.5, 47.4, 1_000.0],
            values,
            writes: Vec::new(),
            accepts_writes: true,
        }
    }

    pub fn address(&self) -> SocketAddr {
        self.socket.local_addr().unwrap()
    }

    pub fn config(&self) -> XPlaneConfig {
        XPlaneConfig {
            simulator: Simulator::At(self.address()),
            ..XPlaneConfig::default()
        }
    }

    /// Discards all subscriptions, like a restarted X-Plane.
    pub fn restart(&mut self) {
        self.subscribed.clear();
        self.client = None;
        self.position_hz = None;
        for path in [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES] {
            self.set(path, 0.0);
        }
    }

    pub fn set(&mut self, path: &str, value: f32) {
        self.values.insert(path.to_owned(), value);
    }

    pub fn value(&self, path: &str) -> f32 {
        self.values[path]
    }

    /// Reads all datagrams that arrived.
    pub fn listen(&mut self) {
        let mut buffer = [0; 2_048];
        while let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
            self.take(&buffer[..length], from);
        }
    }

    pub fn take(&mut self, datagram: &[u8], from: SocketAddr) {
        let i32_at = |at: usize| i32::from_le_bytes(datagram[at..at + 4].try_into().unwrap());
        match &datagram[..5] {
            b"RREF\0" => {
                assert_eq!(datagram.len(), 413);
                self.requests += 1;
                self.client = Some(from);
                let path = text(&datagram[13..]);
                if i32_at(5) == 0 {
                    self.subscribed.remove(&i32_at(9));
                } else {
                    self.subscribed.insert(i32_at(9), path);
                }
            }
            b"RPOS\0" => {
                self.requests += 1;
                self.client = Some(from);
                self.position_hz = Some(text(&datagram[5..]));
            }
            b"DREF\0" => {
                assert_eq!(datagram.len(), 509);
                let value = f32::from_le_bytes(datagram[5..9].try_into().unwrap());
                self.write(text(&datagram[9..]), value);
            }
            b"DATA\0" => {
                assert_eq!((datagram.len() - 5) % 36, 0);
                for row in datagram[5..].chunks(36) {
                    self.write_row(row);
                }
            }
            // Of another test's X-Plane, to a client whose port this one has now.
            b"RREF," | b"RPOS4" | b"DATA*" => {}
            other => panic!("not a message to X-Plane: {other:?}"),
        }
    }

    fn write_row(&mut self, row: &[u8]) {
        let columns: Vec<_> = row[4..]
            .chunks(4)
            .map(|column| f32::from_le_bytes(column.try_into().unwrap()))
            .collect();
        let paths: &[&str] = match row[0] {
            8 => &[YOKE_PITCH, YOKE_ROLL, YOKE_HEADING],
            25 => &[THROTTLE],
            other => panic!("row {other} is not written"),
        };
        for (path, column) in paths.iter().zip(columns) {
            if column > -998.0 {
                self.write((*path).to_owned(), column);
            }
        }
    }

    fn write(&mut self, path: String, value: f32) {
        self.writes.push((path.clone(), value));
        if self.accepts_writes {
            self.values.insert(path, value);
        }
    }

    pub fn assert_shows(&self, path: &str, expected: f32) {
        let shown = self.value(path);
        assert!((shown - expected).abs() < 1e-6, "{path} shows {shown}");
    }

    /// Sends a frame: every subscribed value that exists, in one datagram.
    pub fn send_frame(&self) {
        self.send(&self.frame());
    }

    pub fn frame(&self) -> Vec<u8> {
        let mut datagram = b"RREF,".to_vec();
        for (index, path) in &self.subscribed {
            if let Some(value) = self.values.get(path) {
                datagram.extend(index.to_le_bytes());
                datagram.extend(value.to_le_bytes());
            }
        }
        datagram
    }

    pub fn send(&self, datagram: &[u8]) {
        if let Some(client) = self.client {
            self.sender.send_to(datagram, client).unwrap();
        }
    }

    /// One tick: reads, lets time pass, sends a frame.
    pub fn live(&mut self, seconds: f32) {
        self.listen();
        self.send_next_frame(seconds);
    }

    /// Lets time pass, sends a frame.
    pub fn send_next_frame(&mut self, seconds: f32) {
        let time = self.value(FLIGHT_TIME) + seconds;
        self.set(FLIGHT_TIME, time);
        self.send_frame();
        if self.position_hz.is_some() {
            self.send(&position_reply(self.position));
        }
    }
}

impl FakeXPlane {
    /// Sends the rows of X-Plane 12's Data Output that are flown by, one
    /// datagram, to a port of this machine.
    pub fn send_rows(&self, port: u16) {
        let of = |name: &str| self.value(&format!("{P}{name}"));
        let [longitude, latitude, elevation_m] = self.position.map(|degrees| degrees as f32);
        let altitude_ft = self.value("sim/cockpit2/gauges/indicators/altitude_ft_pilot");
        let rows: [(i32, &[f32]); 8] = [
            (1, &[0.0, 0.0, self.value(FLIGHT_TIME)]),
            (3, &[of("indicated_airspeed")]),
            (4, &[0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.0]),
            (16, &[1.0, -2.0, 3.0]),
            (17, &[of("theta"), of("phi"), of("psi"), of("mag_psi")]),
            (18, &[of("alpha")]),
            (
                20,
                &[
                    latitude,
                    longitude,
                    elevation_m / 0.3048,
                    900.0,
                    0.0,
                    altitude_ft,
                ],
            ),
            (
                21,
                &[
                    0.0,
                    0.0,
                    0.0,
                    of("local_vx"),
                    of("local_vy"),
                    of("local_vz"),
                ],
            ),
        ];
        let mut datagram = b"DATA*".to_vec();
        for (number, columns) in rows {
            datagram.extend(number.to_le_bytes());
            for column in 0..8 {
                let value = columns.get(column).copied().unwrap_or(-999.0);
                datagram.extend(value.to_le_bytes());
            }
        }
        let to = SocketAddrV4::new([127, 0, 0, 1].into(), port);
        self.sender.send_to(&datagram, to).unwrap();
    }
}

/// Up to the NUL, after which there may only be more of them.
fn text(field: &[u8]) -> String {
    let end = field.iter().position(|byte| *byte == 0).expect("no NUL");
    assert!(field[end..].iter().all(|byte| *byte == 0), "not padded");
    String::from_utf8(field[..end].to_vec()).unwrap()
}
