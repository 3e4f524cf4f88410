//! An X-Plane whose aircraft is the built-in one, over a [`Port`] in memory:
//! frame by frame on a clock set by the test.

use std::collections::{HashMap, VecDeque};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard};

use fcc_core::flight::Surfaces;
use fcc_sim::{Aircraft, SimConfig, Truth};
use fcc_xplane::{Errno, Port};

use crate::simulator_silence::datarefs;

pub(crate) const OVERRIDES: [&str; 2] = [
    "sim/operation/override/override_joystick",
    "sim/operation/override/override_throttles",
];
const YOKE: [&str; 3] = [
    "sim/joystick/yoke_pitch_ratio",
    "sim/joystick/yoke_roll_ratio",
    "sim/joystick/yoke_heading_ratio",
];
const THROTTLE: &str = "sim/flightmodel/engine/ENGN_thro_use[0]";
/// Messages that X-Plane takes in a frame (a Laminar developer in
/// charlylima/XPlaneUDP issue 3).
const TAKEN_PER_FRAME: usize = 140;
/// Datagrams that fit a socket of Linux's default size.
const QUEUED: usize = 250;
/// X-Plane makes no longer step.
const LONGEST_STEP_S: f64 = 1.0 / 19.0;

/// What the simulator does with its time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Manner {
    Flying,
    /// It makes no frames.
    Frozen,
    /// A map or an alert: frames in which nothing moves and `paused` is 0.
    Stopped,
    /// A map for which it stops to send, too.
    StoppedSilently,
    Paused,
    /// It shows the flight of a minute ago.
    Replaying,
}

/// The simulator.
pub(crate) struct World {
    pub(crate) aircraft: Aircraft,
    pub(crate) manner: Manner,
    pub(crate) sends: bool,
    pub(crate) hears: bool,
    /// Where the pilot holds stick and pedals.
    pub(crate) stick: f64,
    values: HashMap<String, f64>,
    subscribed: HashMap<i32, String>,
    position_hz: u32,
    /// What is on the way, each with the time of its arrival, ns.
    to_client: VecDeque<(i64, Vec<u8>)>,
    /// How long the network holds it, ns, and the time, ns.
    held_ns: i64,
    now_ns: i64,
    /// When the present frame was made.
    made_ns: i64,
    from_client: VecDeque<Vec<u8>>,
    /// Of our time, ns.
    next_frame_ns: i64,
    frame_ns: i64,
    /// Of uniform numbers, 0 without jitter.
    jitter: u64,
    time_offset_s: f64,
    place_offset_deg: f64,
    frames: u64,
    /// Every write of a dataref that was taken: path and value.
    pub(crate) writes: Vec<(String, f64)>,
    past: VecDeque<Truth>,
}

/// Both ends of a connection.
#[derive(Clone)]
pub(crate) struct Wire(Arc<Mutex<World>>);

impl Port for Wire {
    fn receive(&self, into: &mut [u8]) -> Result<Option<(usize, SocketAddr)>, Errno> {
        let mut world = self.world();
        let now_ns = world.now_ns;
        let next = world
            .to_client
            .pop_front_if(|(due_ns, _)| *due_ns <= now_ns);
        Ok(next.map(|(_, datagram)| {
            let length = datagram.len().min(into.len());
            into[..length].copy_from_slice(&datagram[..length]);
            (length, ([127, 0, 0, 1], 49_001).into())
        }))
    }

    fn send(&self, datagram: &[u8], _: SocketAddr) -> Result<(), Errno> {
        let mut world = self.world();
        if world.hears && world.from_client.len() < QUEUED {
            world.from_client.push_back(datagram.to_vec());
        }
        Ok(())
    }
}

impl Wire {
    pub(crate) fn new(frame_hz: f64, jitter: u64, config: &SimConfig) -> Self {
        let values = [
            ("sim/time/paused", 0.0),
            ("sim/time/is_in_replay", 0.0),
            ("sim/version/xplane_internal_version", 120_800.0),
            ("sim/flightmodel/failures/onground_any", 0.0),
            (
                "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot",
                29.92,
            ),
        ];
        let zeros = OVERRIDES.into_iter().chain(YOKE).map(|path| (path, 0.0));
        let values = values.into_iter().chain(zeros);
        let frame_ns = (1e9 / frame_hz) as i64;
        let config = SimConfig {
            substep_s: 0.01,
            ..config.clone()
        };
        let aircraft = Aircraft::new(&config).unwrap();
        let throttle = (THROTTLE, aircraft.hands_off().throttle);
        Self(Arc::new(Mutex::new(World {
            aircraft,
            manner: Manner::Flying,
            sends: true,
            hears: true,
            stick: 0.1,
            values: values
                .chain([throttle])
                .map(|(path, value)| (path.to_owned(), value))
                .collect(),
            subscribed: HashMap::new(),
            position_hz: 0,
            to_client: VecDeque::new(),
            held_ns: 0,
            now_ns: 0,
            made_ns: 0,
            from_client: VecDeque::new(),
            next_frame_ns: 7_000_000,
            frame_ns,
            jitter,
            time_offset_s: 0.0,
            place_offset_deg: 0.0,
            frames: 0,
            writes: Vec::new(),
            past: VecDeque::new(),
        })))
    }

    pub(crate) fn world(&self) -> MutexGuard<'_, World> {
        self.0.lock().unwrap()
    }
}

impl World {
    /// Makes the frames up to an instant of our clock.
    pub(crate) fn advance_to(&mut self, now_ns: i64) {
        self.now_ns = now_ns;
        while self.next_frame_ns <= now_ns {
            let frame_ns = self.next_frame();
            self.made_ns = self.next_frame_ns;
            self.next_frame_ns += frame_ns;
            if self.manner != Manner::Frozen {
                self.frame(frame_ns as f64 * 1e-9);
            }
        }
    }

    /// From now on the network holds what is sent for so long; at 0 it delivers
    /// all that waits.
    pub(crate) fn hold(&mut self, held_s: f64) {
        self.held_ns = (held_s * 1e9) as i64;
        if self.held_ns == 0 {
            for (due_ns, _) in &mut self.to_client {
                *due_ns = self.now_ns;
            }
        }
    }

    /// A uniform number in 0..1.
    fn draw(&mut self) -> f64 {
        self.jitter = self
            .jitter
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.jitter >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn next_frame(&mut self) -> i64 {
        if self.jitter == 0 {
            return self.frame_ns;
        }
        (self.frame_ns as f64 * (0.6 + 0.8 * self.draw())) as i64
    }

    fn frame(&mut self, frame_s: f64) {
        self.frames += 1;
        for _ in 0..TAKEN_PER_FRAME {
            let Some(datagram) = self.from_client.pop_front() else {
                break;
            };
            self.take(&datagram);
        }
        if self.manner == Manner::Flying {
            let commands = self.commands();
            self.aircraft.step(&commands, frame_s.min(LONGEST_STEP_S));
            self.past.push_front(self.aircraft.truth());
            self.past.truncate(4_000);
        }
        self.send(frame_s);
    }

    fn commands(&self) -> Surfaces {
        let hands_off = self.aircraft.hands_off();
        let of = |path: &str| self.values[path];
        let [joystick, throttles] = OVERRIDES.map(|path| of(path) >= 0.5);
        let [elevator, aileron, rudder] = YOKE.map(of);
        Surfaces {
            throttle: if throttles {
                of(THROTTLE)
            } else {
                hands_off.throttle
            },
            elevator: if joystick {
                elevator
            } else {
                hands_off.elevator
            },
            aileron: if joystick { aileron } else { hands_off.aileron },
            rudder: if joystick { rudder } else { hands_off.rudder },
            ..Surfaces::IDLE
        }
    }

    fn take(&mut self, datagram: &[u8]) {
        let i32_at = |at: usize| i32::from_le_bytes(datagram[at..at + 4].try_into().unwrap());
        match &datagram[..4] {
            b"RREF" => {
                let path = text(&datagram[13..]);
                if i32_at(5) == 0 {
                    self.subscribed.remove(&i32_at(9));
                } else {
                    self.subscribed.insert(i32_at(9), path);
                }
            }
            b"RPOS" => self.position_hz = text(&datagram[5..]).parse().unwrap(),
            b"DREF" => {
                let value = f32::from_le_bytes(datagram[5..9].try_into().unwrap()).into();
                let path = text(&datagram[9..]);
                self.writes.push((path.clone(), value));
                self.values.insert(path, value);
            }
            other => panic!("{other:?}"),
        }
    }

    fn send(&mut self, frame_s: f64) {
        if !self.sends || self.manner == Manner::StoppedSilently {
            return;
        }
        let shown = match self.manner {
            Manner::Replaying => self.past.back().copied(),
            _ => None,
        };
        let truth = shown.unwrap_or_else(|| self.aircraft.truth());
        self.values
            .insert("sim/time/framerate_period".into(), frame_s);
        let flag = |set: bool| f64::from(u8::from(set));
        let (paused, replaying) = (Manner::Paused, Manner::Replaying);
        self.values
            .insert("sim/time/paused".into(), flag(self.manner == paused));
        self.values.insert(
            "sim/time/is_in_replay".into(),
            flag(self.manner == replaying),
        );
        let mut datagram = b"RREF,".to_vec();
        for (index, path) in &self.subscribed {
            if let Some(value) = self.value(&truth, path) {
                datagram.extend(index.to_le_bytes());
                datagram.extend((value as f32).to_le_bytes());
            }
        }
        self.queue(datagram);
        // About 20 a second.
        let every = (0.05 / frame_s).round().max(1.0) as u64;
        if self.position_hz > 0 && self.frames.is_multiple_of(every) {
            let north_deg = truth.north_m / 111_195.0 + self.place_offset_deg;
            let east_deg = truth.east_m / 111_195.0;
            let mut datagram = b"RPOS4".to_vec();
            for field in [east_deg, north_deg, truth.altitude_m] {
                datagram.extend(field.to_le_bytes());
            }
            datagram.extend([0; 40]);
            self.queue(datagram);
        }
    }

    /// The indices that were subscribed.
    pub(crate) fn indices(&self) -> Vec<i32> {
        let mut indices: Vec<i32> = self.subscribed.keys().copied().collect();
        indices.sort_unstable();
        indices
    }

    /// A datagram of another program, from this simulator's address and port.
    pub(crate) fn forge(&mut self, datagram: Vec<u8>) {
        self.to_client.push_back((self.now_ns, datagram));
    }

    fn queue(&mut self, datagram: Vec<u8>) {
        if self.to_client.len() < QUEUED {
            self.to_client
                .push_back((self.made_ns + self.held_ns, datagram));
        }
    }

    /// A dataref's value; none if it does not exist.
    fn value(&self, truth: &Truth, path: &str) -> Option<f64> {
        if let Some(value) = self.values.get(path) {
            return Some(*value);
        }
        match path.rsplit('/').next().unwrap() {
            // A real clock: it runs on in all manners.
            "network_time_sec" => Some(900.0 + self.made_ns as f64 * 1e-9),
            "total_flight_time_sec" => Some(truth.time_s + self.time_offset_s),
            _ if path.contains("generic_lights_switch") => Some(0.0),
            _ if path.contains("joy_mapped_axis_value") => Some(self.stick),
            name => datarefs::of(truth, name),
        }
    }

    /// Loads a flight: another aircraft, elsewhere; clock and overrides are
    /// reset.
    pub(crate) fn load_flight(&mut self) {
        self.aircraft = Aircraft::new(&SimConfig {
            altitude_m: 300.0,
            heading_rad: 2.0,
            ..config()
        })
        .unwrap();
        self.place_offset_deg = 2.0;
        self.reload();
        self.values.insert(THROTTLE.into(), 0.0);
        self.past.clear();
    }

    /// Clears the overrides, as when the aircraft is loaded again.
    pub(crate) fn reload(&mut self) {
        for path in OVERRIDES {
            self.values.insert(path.into(), 0.0);
        }
    }

    pub(crate) fn is_overridden(&self) -> bool {
        OVERRIDES.iter().any(|path| self.values[*path] >= 0.5)
    }
}

/// Steps as long as a frame, for speed.
fn config() -> SimConfig {
    SimConfig {
        substep_s: 0.01,
        ..SimConfig::default()
    }
}

fn text(field: &[u8]) -> String {
    let end = field.iter().position(|byte| *byte == 0).unwrap();
    String::from_utf8(field[..end].to_vec()).unwrap()
}
