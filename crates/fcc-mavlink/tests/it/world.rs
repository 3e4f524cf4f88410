//! A vehicle, and the stations around it, in lockstep.

use std::collections::{BTreeMap, VecDeque};

use fcc_mavlink::{
    Action, Flight, Health, Identity, Key, LinkId, LinkOptions, Mode, Motion, Now, Outcome,
    Position, Protocol, Request, Settings, VehicleState,
};
use fcc_plan::Plan;
use mavlink::dialects::common::{
    MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMessage, MavMissionType,
};
use mavlink::{MAVLinkV2MessageRaw, MavHeader, MavlinkVersion, Message as _};

pub(crate) const STEP_MS: u64 = 10;
/// 2026-11-29.
pub(crate) const UTC_US: u64 = 1_795_900_000_000_000;
/// A link that sends nothing by itself but every 5 s: the tests' traffic is theirs.
pub(crate) const QUIET: LinkOptions = LinkOptions {
    bytes_per_s: 1e6,
    is_datagram: true,
    is_high_latency: true,
};

/// A message that came to a station.
#[derive(Clone, Debug)]
pub(crate) struct Heard {
    pub(crate) link: LinkId,
    pub(crate) message: MavMessage,
}

/// What a link does to frames: probability of loss, and delays, ms.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Weather {
    pub(crate) loss: f64,
    pub(crate) delay_ms: (u64, u64),
}

pub(crate) struct World {
    pub(crate) protocol: Protocol,
    pub(crate) ms: u64,
    pub(crate) state: VehicleState,
    /// The plan that the vehicle has taken.
    pub(crate) plan: Plan,
    pub(crate) weather: Weather,
    /// What the vehicle refuses, and how long it takes, ms.
    pub(crate) refuses: Option<String>,
    pub(crate) takes_ms: u64,
    /// What was asked of the vehicle.
    pub(crate) asked: Vec<Action>,
    waiting: Vec<(u64, Request)>,
    up: BTreeMap<(u64, u64), (LinkId, Vec<u8>)>,
    down: BTreeMap<(u64, u64), (LinkId, Vec<u8>)>,
    pub(crate) inbox: VecDeque<Heard>,
    /// Commands and their results, by their bytes: the crate reads no number that it lacks.
    pub(crate) acks: Vec<(u16, u8)>,
    /// Bytes that the vehicle has sent on each link.
    pub(crate) sent: BTreeMap<LinkId, usize>,
    counter: u64,
    random: u64,
    sequence: u8,
    /// Frames that pass until the link is cut, if it is to be.
    pub(crate) cut_after: Option<usize>,
}

impl World {
    pub(crate) fn new() -> Self {
        Self::with(None, QUIET)
    }

    pub(crate) fn with(key: Option<Key>, options: LinkOptions) -> Self {
        let now = Now {
            ms: 0,
            utc_us: UTC_US,
        };
        let settings = Settings {
            system: 1,
            identity: Identity::Generic,
            key,
            newest_time_stamp: 0,
        };
        let mut protocol = Protocol::new(settings, now);
        for link in 1..=3 {
            protocol.open(link, options, now);
        }
        let mut world = Self {
            protocol,
            ms: 0,
            state: standing(),
            plan: Plan::default(),
            weather: Weather::default(),
            refuses: None,
            takes_ms: 0,
            asked: Vec::new(),
            waiting: Vec::new(),
            up: BTreeMap::new(),
            down: BTreeMap::new(),
            inbox: VecDeque::new(),
            acks: Vec::new(),
            sent: BTreeMap::new(),
            counter: 0,
            random: 0x9e37_79b9_7f4a_7c15,
            sequence: 0,
            cut_after: None,
        };
        world.protocol.set_state(world.state);
        world
    }

    pub(crate) fn now(&self) -> Now {
        Now {
            ms: self.ms,
            utc_us: UTC_US + self.ms * 1_000,
        }
    }

    pub(crate) fn set_state(&mut self, change: impl FnOnce(&mut VehicleState)) {
        change(&mut self.state);
        self.protocol.set_state(self.state);
    }

    /// Marsaglia (2003), "Xorshift RNGs".
    pub(crate) fn random(&mut self) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        self.random
    }

    fn chance(&mut self) -> f64 {
        (self.random() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// When a frame arrives; none: it is lost.
    fn arrives(&mut self) -> Option<(u64, u64)> {
        self.counter += 1;
        if let Some(left) = &mut self.cut_after {
            *left = left.checked_sub(1)?;
        }
        if self.chance() < self.weather.loss {
            return None;
        }
        let (shortest, longest) = self.weather.delay_ms;
        let delay_ms = shortest + self.random() % (longest - shortest + 1);
        Some((self.ms + delay_ms, self.counter))
    }

    /// A frame of a station.
    pub(crate) fn frame(&mut self, (system, component): (u8, u8), message: &MavMessage) -> Vec<u8> {
        self.sequence = self.sequence.wrapping_add(1);
        let header = MavHeader {
            system_id: system.into(),
            component_id: component,
            sequence: self.sequence,
        };
        let mut raw = MAVLinkV2MessageRaw::new();
        raw.serialize_message(header, message);
        raw.raw_bytes().to_vec()
    }

    pub(crate) fn send(&mut self, link: LinkId, message: &MavMessage) {
        let frame = self.frame((255, 190), message);
        self.send_bytes(link, frame);
    }

    pub(crate) fn send_bytes(&mut self, link: LinkId, bytes: Vec<u8>) {
        if let Some(at) = self.arrives() {
            self.up.insert(at, (link, bytes));
        }
    }

    /// Another 10 ms.
    pub(crate) fn step(&mut self) {
        self.ms += STEP_MS;
        let later = self.up.split_off(&(self.ms + 1, 0));
        for (_, (link, bytes)) in std::mem::replace(&mut self.up, later) {
            self.protocol.receive(link, &bytes, self.now());
        }
        for request in self.protocol.requests() {
            self.asked.push(request.action.clone());
            self.waiting.push((self.ms + self.takes_ms, request));
        }
        let due = |(at, _): &mut (u64, Request)| *at <= self.ms;
        let due: Vec<_> = self.waiting.extract_if(.., due).collect();
        for (_, request) in due {
            let outcome = self.carry_out(&request.action);
            self.protocol.finish(request.ticket, &outcome);
        }
        let mut out = Vec::new();
        self.protocol
            .step(self.now(), |link, frame| out.push((link, frame)));
        for (link, frame) in out {
            *self.sent.entry(link).or_default() += frame.len();
            if let Some(at) = self.arrives() {
                self.down.insert(at, (link, frame));
            }
        }
        let later = self.down.split_off(&(self.ms + 1, 0));
        for (_, (link, frame)) in std::mem::replace(&mut self.down, later) {
            if frame[7..10] == [77, 0, 0] {
                let number = u16::from_le_bytes([frame[10], frame[11]]);
                // Zeros at the end are cut off.
                self.acks
                    .push((number, if frame[1] > 2 { frame[12] } else { 0 }));
            }
            self.inbox
                .extend(parsed(&frame).map(|message| Heard { link, message }));
        }
    }

    fn carry_out(&mut self, action: &Action) -> Outcome {
        if let Some(why) = &self.refuses {
            return Err(why.clone());
        }
        let Action::Plan { plan, .. } = action else {
            return Ok(0);
        };
        self.plan = (**plan).clone();
        let hash = self.plan.hash().first_64_bits();
        self.set_state(|state| state.plan_hash = hash);
        Ok(hash)
    }

    /// Steps until a message is there, which is taken.
    pub(crate) fn wait<T>(
        &mut self,
        within_ms: u64,
        mut wanted: impl FnMut(&Heard) -> Option<T>,
    ) -> Option<T> {
        let until_ms = self.ms + within_ms;
        loop {
            while let Some(heard) = self.inbox.pop_front() {
                if let Some(found) = wanted(&heard) {
                    return Some(found);
                }
            }
            if self.ms >= until_ms {
                return None;
            }
            self.step();
        }
    }

    /// Everything that comes within a time.
    pub(crate) fn all(&mut self, within_ms: u64) -> Vec<MavMessage> {
        let mut all = Vec::new();
        let _ = self.wait(within_ms, |heard| {
            all.push(heard.message.clone());
            None::<()>
        });
        all
    }
}

/// A message by the crate's own parser; none if it is not of the dialect.
fn parsed(frame: &[u8]) -> Option<MavMessage> {
    let length = usize::from(frame[1]);
    let id = u32::from_le_bytes([frame[7], frame[8], frame[9], 0]);
    let payload = &frame[10..10 + length];
    let crc = mavlink::calculate_crc(&frame[1..10 + length], MavMessage::extra_crc(id));
    let message = MavMessage::parse(MavlinkVersion::V2, id, payload).ok()?;
    assert_eq!(crc.to_le_bytes(), frame[10 + length..12 + length]);
    Some(message)
}

/// On its wheels at 47.5° N, 9° E, 400 m, without a plan.
fn standing() -> VehicleState {
    VehicleState {
        is_connected: true,
        motion: Motion {
            position: Some(Position {
                latitude_rad: 47.5_f64.to_radians(),
                longitude_rad: 9.0_f64.to_radians(),
                altitude_m: 400.0,
            }),
            ..Motion::default()
        },
        health: Health {
            may_engage: true,
            ..Health::default()
        },
        ..VehicleState::default()
    }
}

/// Makes it fly its mission.
pub(crate) fn flying(state: &mut VehicleState) {
    state.flight = Flight {
        mode: Mode::Plan,
        is_engaged: true,
        is_airborne: true,
        item: 1,
        altitude_m: 700.0,
        ..Flight::default()
    };
    state.home = Some(Position {
        latitude_rad: 47.5_f64.to_radians(),
        longitude_rad: 9.0_f64.to_radians(),
        altitude_m: 400.0,
    });
}

/// A waypoint at a place that tells which one it is.
pub(crate) fn waypoint(n: u16) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        param4: f32::NAN,
        x: 475_000_000 + 1_000 * i32::from(n),
        y: 90_000_000,
        z: 300.0,
        seq: n,
        command: MavCmd::MAV_CMD_NAV_WAYPOINT,
        target_system: 1,
        target_component: 1,
        frame: MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        autocontinue: 1,
        mission_type: MavMissionType::MAV_MISSION_TYPE_MISSION,
        ..MISSION_ITEM_INT_DATA::default()
    }
}
