//! The multicopter as an AR.Drone: its clients fly it over UDP.

use std::io;
use std::net::{IpAddr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use fcc_ardrone::{
    COMMANDS_PORT, Flight, NAVDATA_BYTES, NAVDATA_PORT, Seen, Session, Stick, Wanted,
};
use fcc_core::framework::{LoopCommand, RecordOf, State};
use fcc_multicopter::{Command, Mode, Multicopter, Tilt};
use serde::{Deserialize, Serialize};

use crate::flight::{Access, FlightTime, Observer, Reports};

/// The height of a take-off, m: the AR.Drone's.
const TAKES_OFF_TO_M: f64 = 1.0;
/// How often a client is told of the state: 15 times a second, as it has asked for.
const TELLS_EVERY: Duration = Duration::from_millis(66);
/// How often a command is repeated while it is wanted: a stick is let go after 2 s.
const REPEATS_EVERY: Duration = Duration::from_secs(1);
/// A client that is silent for so long is no longer the only one.
const LEFT_AFTER: Duration = Duration::from_secs(15);
/// So many datagrams are read at a time.
const MOST_AT_A_TIME: usize = 64;

/// `[ardrone]`.
#[derive(Clone, PartialEq, Debug, Default, Deserialize, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct ArDroneKeys {
    /// Of this computer, at which clients of the AR.Drone fly it instead of a plan.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub address: Option<IpAddr>,
}

/// What clients talk to.
pub(super) struct ArDrone {
    commands: UdpSocket,
    navdata: UdpSocket,
    began: Instant,
    session: Session,
    client: Option<Client>,
    seen: Seen,
    mode: Mode,
    is_engaged: bool,
    /// From true to magnetic north, rad.
    variation_rad: f64,
    given: Option<(Command, Duration)>,
    told: Duration,
    is_malformed: bool,
}

/// Who flies it.
struct Client {
    address: IpAddr,
    heard: Duration,
    /// Where it wants to be told of the state.
    listens: Option<SocketAddr>,
}

impl ArDrone {
    pub(super) fn open(address: IpAddr, variation_rad: f64) -> Result<Self, String> {
        let socket = |port: u16| {
            let open = |socket: UdpSocket| socket.set_nonblocking(true).map(|()| socket);
            UdpSocket::bind((address, port)).and_then(open).map_err(|error| {
                format!(
                    "UDP port {port} of {address} cannot be opened: {error}; end the program that \
                     uses it, or choose another ardrone.address"
                )
            })
        };
        Ok(Self {
            commands: socket(COMMANDS_PORT)?,
            navdata: socket(NAVDATA_PORT)?,
            began: Instant::now(),
            session: Session::default(),
            client: None,
            seen: Seen::default(),
            mode: Mode::Idle,
            is_engaged: false,
            variation_rad,
            given: None,
            told: Duration::ZERO,
            is_malformed: false,
        })
    }

    /// Whether a datagram is of the one client that flies it.
    fn admits(&mut self, from: SocketAddr, now: Duration, reports: &mut Reports) -> bool {
        let is_left = |client: &Client| now.saturating_sub(client.heard) > LEFT_AFTER;
        if self.client.as_ref().is_none_or(is_left) {
            reports.commander(&format!("an AR.Drone client at {}", from.ip()));
            self.session = Session::default();
            self.client = Some(Client {
                address: from.ip(),
                heard: now,
                listens: None,
            });
        }
        let client = self.client.as_mut();
        client.is_some_and(|client| {
            let is_its = client.address == from.ip();
            if is_its {
                client.heard = now;
            }
            is_its
        })
    }

    fn read(&mut self, now: Duration, reports: &mut Reports) {
        let mut datagram = [0; 2048];
        for _ in 0..MOST_AT_A_TIME {
            let Ok((length, from)) = self.commands.recv_from(&mut datagram) else {
                break;
            };
            if !self.admits(from, now, reports) {
                continue;
            }
            let text = datagram.get(..length).unwrap_or_default();
            if let Err(wrong) = self.session.read(text, now)
                && !self.is_malformed
            {
                self.is_malformed = true;
                reports.mention(format!("from {from}: {wrong}; others are not reported"));
            }
        }
        for _ in 0..MOST_AT_A_TIME {
            let Ok((_, from)) = self.navdata.recv_from(&mut datagram) else {
                break;
            };
            if self.admits(from, now, reports)
                && let Some(client) = &mut self.client
            {
                client.listens = Some(from);
            }
        }
    }

    /// The command for what the client wants; none if that is flown.
    fn command(&self, wanted: Wanted) -> Option<Command> {
        match (wanted, self.mode) {
            (Wanted::StopMotors, Mode::Idle)
            | (Wanted::Land, Mode::Idle | Mode::Land | Mode::Descend)
            | (Wanted::Hover, Mode::Hover) => None,
            (Wanted::StopMotors, _) => Some(Command::StopMotors),
            (Wanted::Land, _) => Some(Command::Land),
            (_, Mode::Idle) => Some(Command::TakeOff(TAKES_OFF_TO_M)),
            (_, Mode::TakeOff) => None,
            (Wanted::Hover, _) => Some(Command::Hover),
            (Wanted::Fly(stick), _) => Some(Command::Tilt(self.tilt(stick))),
        }
    }

    fn tilt(&self, stick: Stick) -> Tilt {
        let limits = self.session.limits();
        let (mut ahead, mut aside) = (-stick.pitch, stick.roll);
        if let Some(half_turns) = stick.heading {
            let [_, _, heading_rad] = self.seen.attitude_rad;
            let device_rad = half_turns * std::f64::consts::PI + self.variation_rad;
            let (sin, cos) = (device_rad - heading_rad).sin_cos();
            (ahead, aside) = (cos * ahead - sin * aside, sin * ahead + cos * aside);
        }
        let climb_mps = stick.climb * limits.climb_mps;
        let is_high = self.seen.height_m >= limits.height_m;
        Tilt {
            roll_rad: aside * limits.tilt_rad,
            pitch_rad: -ahead * limits.tilt_rad,
            climb_mps: if is_high {
                climb_mps.min(0.0)
            } else {
                climb_mps
            },
            yaw_radps: stick.yaw * limits.yaw_radps,
        }
    }

    fn tell(&mut self, now: Duration) -> io::Result<()> {
        let Some(to) = self.client.as_ref().and_then(|client| client.listens) else {
            return Ok(());
        };
        let mut bytes = [0; NAVDATA_BYTES];
        let length = self.session.write(&self.seen, now, &mut bytes);
        let datagram = bytes.get(..length).unwrap_or_default();
        self.navdata.send_to(datagram, to).map(|_| ())
    }
}

impl Observer<Multicopter> for ArDrone {
    fn record(&mut self, record: &RecordOf<Multicopter>, _: &FlightTime) {
        let is = &record.estimate;
        let (sin, cos) = is.heading_rad.sin_cos();
        self.mode = record.setpoints.mode;
        self.is_engaged = record.state.state() == State::Engaged;
        self.seen = Seen {
            flight: match self.mode {
                Mode::Idle => Flight::Landed,
                Mode::TakeOff => Flight::TakesOff,
                Mode::Hover => Flight::Hovers,
                Mode::Land | Mode::Descend => Flight::Lands,
                _ => Flight::Flies,
            },
            battery: record.measurements.battery.value.charge.unwrap_or(1.0),
            attitude_rad: [is.roll_rad, is.pitch_rad, is.heading_rad],
            height_m: is.height_m,
            velocity_mps: [
                cos * is.north_mps + sin * is.east_mps,
                cos * is.east_mps - sin * is.north_mps,
                -is.climb_mps,
            ],
        };
    }

    fn poll(&mut self, access: &mut Access<'_, Command>) {
        let now = self.began.elapsed();
        self.read(now, access.reports);
        let wanted = self.session.wanted(now);
        if let Some(command) = self.command(wanted)
            && self.is_engaged
        {
            let is_new = self.given.is_none_or(|(last, at)| {
                last != command || now.saturating_sub(at) >= REPEATS_EVERY
            });
            if is_new
                && access
                    .commands
                    .send(LoopCommand::Controller(command))
                    .is_ok()
            {
                self.given = Some((command, now));
            }
        }
        if now.saturating_sub(self.told) >= TELLS_EVERY {
            self.told = now;
            // A client that has gone does not listen.
            let _ = self.tell(now);
        }
    }
}
