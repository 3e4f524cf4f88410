//! The protocol as a whole: bytes in, bytes and requests out, time passed in.

use fcc_telemetry::Command;
use mavlink::dialects::common::{
    MESSAGE_INTERVAL_DATA, MISSION_ITEM_REACHED_DATA, MavMessage, MavResult, MavSeverity,
    TIMESYNC_DATA,
};

use crate::command::{OfProtocol, Received, Refusal, Situation, Todo, choose, row_of};
use crate::commands::Commands;
use crate::control::Control;
use crate::effects::{Effects, Peer};
use crate::frame::{Body, Frame};
use crate::item::MissionItem;
use crate::link::{COMPONENT, LinkOptions, Links};
use crate::log::{Log, LogWanted, Logs};
use crate::message::{Scene, id, mission_current, requested};
use crate::mission::{Missions, denied};
use crate::mode::by_custom_mode;
use crate::parameter::{Parameter, Parameters};
use crate::signing::{Key, Signing};
use crate::vehicle::LinkId;
use crate::vehicle::{Action, Identity, Mode, Now, Outcome, Request, VehicleState};

/// Who speaks, and how it is secured.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The system number, 1 to 255.
    pub system: u8,
    /// Who the vehicle says that it is.
    pub identity: Identity,
    /// With a key, only what is signed with it is read.
    pub key: Option<Key>,
    /// [`Protocol::newest_time_stamp`] of the run before; 0 without one.
    pub newest_time_stamp: u64,
}

/// The vehicle's side of MAVLink on any number of links.
///
/// ```
/// use fcc_mavlink::{Identity, LinkOptions, Now, Protocol, Settings, VehicleState};
///
/// let settings = Settings {
///     system: 1,
///     identity: Identity::Generic,
///     key: None,
///     newest_time_stamp: 0,
/// };
/// let mut protocol = Protocol::new(settings, Now::default());
/// let link = LinkOptions { bytes_per_s: 1e6, is_datagram: true, is_high_latency: false };
/// protocol.open(7, link, Now::default());
/// protocol.set_state(VehicleState::default());
/// let mut frames = Vec::new();
/// protocol.step(Now::default(), |link, frame| frames.push((link, frame)));
/// // A heartbeat is the first: of version 2 (0xFD), from system 1, component 1.
/// assert_eq!((frames[0].0, frames[0].1[0]), (7, 0xFD));
/// assert_eq!(frames[0].1[5..7], [1, 1]);
/// ```
#[derive(Debug)]
pub struct Protocol {
    settings: Settings,
    state: VehicleState,
    links: Links,
    signing: Signing,
    commands: Commands,
    missions: Missions,
    parameters: Parameters,
    logs: Logs,
    control: Control,
    fx: Effects,
    /// Another system with this one's number was heard, and that was said.
    has_twin: bool,
    /// The mission was chosen in standby: that mode is shown until control is taken.
    has_chosen: bool,
    /// `MISSION_SET_CURRENT` that is being carried out, and its item.
    setting_current: Option<(u32, Peer, u16)>,
}

impl Protocol {
    /// Without links, before anything is known.
    pub fn new(settings: Settings, now: Now) -> Self {
        let signing = Signing::new(settings.key.clone(), settings.newest_time_stamp, now);
        Self {
            settings,
            state: VehicleState::default(),
            links: Links::default(),
            signing,
            commands: Commands::default(),
            missions: Missions::default(),
            parameters: Parameters::default(),
            logs: Logs::default(),
            control: Control::default(),
            fx: Effects::default(),
            has_twin: false,
            has_chosen: false,
            setting_current: None,
        }
    }

    /// Begins to use a link.
    pub fn open(&mut self, link: LinkId, options: LinkOptions, now: Now) {
        self.links.open(link, options, now);
    }

    /// A link has ended.
    pub fn close(&mut self, link: LinkId) {
        self.links.close(link);
        self.parameters.forget(link);
        self.logs.forget(link);
        self.missions.close(link);
    }

    /// The newest state of the vehicle.
    pub fn set_state(&mut self, state: VehicleState) {
        self.state = state;
        self.has_chosen &= !state.flight.is_engaged && state.flight.mode == Mode::Standby;
        if self.has_chosen {
            self.state.flight.mode = Mode::Plan;
        }
        self.missions.note(&state);
    }

    /// No record has come for some time: what is known is old, and is not told as new.
    pub fn set_old(&mut self) {
        if self.state.is_connected && !self.state.is_old {
            self.state.is_old = true;
            let text = "fccd sends nothing: where the aircraft is, is not known";
            self.fx.announce(MavSeverity::MAV_SEVERITY_CRITICAL, text);
        }
    }

    /// The vehicle's plan, if its hash is not [`plan_hash`](Self::plan_hash); none: its
    /// content is not known.
    pub fn set_plan(&mut self, hash: u64, plan: Option<&fcc_plan::Plan>) {
        self.missions.set_plan(hash, plan);
    }

    /// The hash of the plan that is known here.
    pub const fn plan_hash(&self) -> u64 {
        self.missions.hash()
    }

    /// All parameters.
    pub fn set_parameters(&mut self, all: Vec<Parameter>) {
        self.parameters.set_all(all);
    }

    /// What stations need of the recordings, once.
    pub fn wanted_log(&mut self) -> Option<LogWanted> {
        self.logs.wanted()
    }

    /// All recordings, the oldest first.
    pub fn set_logs(&mut self, all: Vec<Log>) {
        self.logs.set_all(all);
    }

    /// Bytes of a recording from here on; fewer than were wanted at its end.
    pub fn set_log_data(&mut self, log: u16, at: u32, bytes: Vec<u8>) {
        self.logs.set_data(log, at, bytes);
    }

    /// The system number of the station that has taken control; none: all may command.
    pub fn owner(&self) -> Option<u8> {
        self.control.owner()
    }

    /// To be kept for the next run, so that no recorded frame is read again.
    pub const fn newest_time_stamp(&self) -> u64 {
        self.signing.newest()
    }

    /// An event, as text.
    pub fn event(&mut self, severity: Severity, text: &str) {
        let severity = match severity {
            Severity::Critical => MavSeverity::MAV_SEVERITY_CRITICAL,
            Severity::Warning => MavSeverity::MAV_SEVERITY_WARNING,
            Severity::Notice => MavSeverity::MAV_SEVERITY_NOTICE,
            Severity::Info => MavSeverity::MAV_SEVERITY_INFO,
        };
        self.fx.announce(severity, text);
    }

    /// An item of the mission was reached, from 1.
    pub fn item_reached(&mut self, item: u16) {
        if let Some(seq) = item.checked_sub(1) {
            let reached = MISSION_ITEM_REACHED_DATA { seq };
            let body = Body::from(MavMessage::MISSION_ITEM_REACHED(reached));
            self.fx.broadcasts.push(body);
        }
    }

    /// Takes what has arrived on a link; returns whether a frame of it was read.
    pub fn receive(&mut self, link: LinkId, bytes: &[u8], now: Now) -> bool {
        let mut is_read = false;
        for frame in self.links.frames(link, bytes) {
            if self.signing.permits(&frame, now) {
                is_read = true;
                self.handle(link, &frame, now);
            }
        }
        is_read
    }

    /// What is wanted from the vehicle; each is answered by [`finish`](Self::finish).
    pub fn requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.fx.requests)
    }

    /// What became of a request.
    pub fn finish(&mut self, ticket: u32, outcome: &Outcome) {
        let set = self.setting_current.take_if(|one| one.0 == ticket);
        if let Some((_, peer, item)) = set {
            match outcome {
                Ok(_) => self.answer_current(peer, Some(item)),
                Err(why) => self.fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why),
            }
            return;
        }
        let fx = &mut self.fx;
        if !self.missions.finish(ticket, outcome, fx)
            && !self.parameters.finish(ticket, outcome, fx)
        {
            self.commands.finish(ticket, outcome, fx);
        }
    }

    /// Does what is due, and sends; to be called every 20 ms or more often.
    pub fn step(&mut self, now: Now, out: impl FnMut(LinkId, Vec<u8>)) {
        self.missions.step(now, &mut self.fx);
        self.commands.step(now, &mut self.fx);
        if let Some(system) = self.control.lost(now) {
            let text = format!("station {system} is not heard: control is free");
            self.fx.announce(MavSeverity::MAV_SEVERITY_WARNING, &text);
        }
        let is_engaged = self.state.is_connected && self.state.flight.is_engaged;
        if let Some((peer, within_s)) = self.control.promise(is_engaged, now) {
            let promise = vec![Command::set([("heartbeat_s", within_s)])];
            self.fx.request(peer, Action::Commands(promise), now);
        }
        for (link, body) in self.fx.answers.drain(..) {
            self.links.answer(link, body);
        }
        for body in self.fx.broadcasts.drain(..) {
            self.links.broadcast(&body);
        }
        let scene = Scene {
            state: &self.state,
            missions: &self.missions,
            identity: self.settings.identity,
            system: self.settings.system,
            now,
        };
        let status = self.control.status();
        let shared = (&mut self.parameters, &mut self.logs, &mut self.signing);
        self.links.send(&scene, status.as_ref(), shared, out);
    }

    /// Whether a message is for this system: it names it, or all.
    fn is_for_here(&self, [system, component]: [u8; 2]) -> bool {
        [0, self.settings.system].contains(&system) && [0, COMPONENT].contains(&component)
    }

    fn handle(&mut self, link: LinkId, frame: &Frame, now: Now) {
        let peer = Peer {
            link,
            system: frame.system,
            component: frame.component,
        };
        if peer.system == self.settings.system && peer.component == COMPONENT {
            if !self.has_twin {
                let text = format!("another vehicle has system number {}, too", peer.system);
                self.fx.announce(MavSeverity::MAV_SEVERITY_CRITICAL, &text);
                self.has_twin = true;
            }
            return;
        }
        let fields = &frame.payload;
        // Where the target is.
        let target = match frame.id {
            id::HEARTBEAT => return self.control.hear(peer, now),
            11 | 117 => 4,
            20 | 38 | 23 => {
                if frame.id == 20 {
                    2
                } else {
                    4
                }
            }
            21 | 43 | 45 | 47 | 121 | 122 => 0,
            40 | 41 | 44 | 51 => 2,
            39 | 73 => 32,
            75 | 76 => 30,
            110 => 1,
            111 => 16,
            119 => 10,
            _ => return,
        };
        let mut target: [u8; 2] = fields.bytes(target);
        if frame.id == 11 {
            // It names a system only.
            target[1] = 0;
        }
        if !self.is_for_here(target) {
            return;
        }
        // What the vehicle's plan is, is being found out: stations ask again.
        let is_known = !self.state.is_connected || self.state.plan_hash == self.missions.hash();
        if matches!(frame.id, 38 | 43 | 44 | 45) && !is_known {
            return;
        }
        let may = self.control.permits(peer);
        let (state, missions, fx) = (&self.state, &mut self.missions, &mut self.fx);
        match frame.id {
            11 => self.set_mode(peer, frame, now),
            20 => self.parameters.read(peer, fields, fx),
            21 => self.parameters.read_all(peer),
            23 => self.parameters.set(peer, may, fields, now, fx),
            40 | 51 => {
                missions.read_item(peer, (fields.u8(4), fields.u16(0)), state, now, fx);
            }
            43 => missions.read_list(peer, fields.u8(2), now, fx),
            47 => missions.acknowledged(peer),
            38 | 39 | 41 | 44 | 45 | 73 if !may => {
                let part = match frame.id {
                    38 => Some(6),
                    39 | 73 => Some(37),
                    44 => Some(4),
                    45 => Some(2),
                    _ => None,
                };
                if let Some(at) = part {
                    fx.answer(peer, denied(peer, fields.u8(at)));
                }
                self.not_in_control(peer);
            }
            38 => {
                let range = (fields.u8(6), fields.i16(0), fields.i16(2));
                missions.begin_partial(peer, range, now, fx);
            }
            41 => self.set_current(peer, fields.u16(0), now),
            44 => missions.begin(peer, (fields.u8(4), fields.u16(0)), state, now, fx),
            45 => missions.clear(peer, fields.u8(2), state, now, fx),
            39 | 73 => {
                let item = MissionItem::read(fields, frame.id == 39);
                missions.item(peer, fields.u8(37), item, state, now, fx);
            }
            75 => self.command((peer, frame.sequence), &Received::int(fields), now),
            76 => self.command((peer, frame.sequence), &Received::long(fields), now),
            110 => fx.answer(peer, no_files(peer, frame)),
            111 if fields.i64(0) == 0 => {
                fx.answer(peer, MavMessage::TIMESYNC(timesync(peer, frame, now)));
            }
            117..=122 => self.logs.take(peer, frame.id, fields, fx),
            _ => {}
        }
    }

    fn scene(&self, now: Now) -> Scene<'_> {
        Scene {
            state: &self.state,
            missions: &self.missions,
            identity: self.settings.identity,
            system: self.settings.system,
            now,
        }
    }

    fn not_in_control(&mut self, peer: Peer) {
        let text = format!(
            "station {} is in control",
            self.control.owner().unwrap_or(0)
        );
        self.fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, &text);
    }

    /// `MISSION_SET_CURRENT`: the answer is the current item, once it is that one. Stations
    /// send it again at each answer with another one.
    fn set_current(&mut self, peer: Peer, item: u16, now: Now) {
        if self.setting_current.is_some_and(|(_, _, set)| set == item) {
            return;
        }
        let command = Received::of(224, [item.into(), f64::NAN]);
        match self.carry_out(peer, &command, now) {
            Ok(Some(ticket)) => self.setting_current = Some((ticket, peer, item)),
            Ok(None) => self.answer_current(peer, None),
            Err((_, why)) => self.fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, &why),
        }
    }

    fn answer_current(&mut self, peer: Peer, item: Option<u16>) {
        let mut current = mission_current(&self.scene(Now::default()));
        current.seq = item.unwrap_or(current.seq);
        self.fx.answer(peer, MavMessage::MISSION_CURRENT(current));
    }

    /// `SET_MODE`, which has no answer but a text.
    fn set_mode(&mut self, peer: Peer, frame: &Frame, now: Now) {
        if !self.control.permits(peer) {
            return self.not_in_control(peer);
        }
        let situation = Situation {
            state: &self.state,
            missions: &self.missions,
        };
        match choose(by_custom_mode(frame.payload.u32(0)), &situation) {
            Ok(Todo::Vehicle(commands)) => {
                self.fx.request(peer, Action::Commands(commands), now);
            }
            Ok(Todo::Protocol(of)) => drop(self.of_protocol(peer, of, now)),
            Ok(Todo::Nothing) => {}
            Err((_, why)) => self.fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, &why),
        }
    }

    /// A command in either encoding: exactly one final answer.
    fn command(&mut self, (peer, sequence): (Peer, u8), received: &Received, now: Now) {
        // What only asks is answered again in full: the message may be lost, too.
        let is_once = row_of(received.number).is_some_and(|row| row.controls);
        let fx = &mut self.fx;
        if is_once && !self.commands.begin((peer, sequence), received, now, fx) {
            return;
        }
        let result = match self.carry_out(peer, received, now) {
            Ok(Some(ticket)) => return self.commands.run(ticket, peer, received.number, now),
            Ok(None) => Ok(()),
            Err(refusal) => Err(refusal),
        };
        self.commands
            .end(peer, received.number, &result, &mut self.fx);
    }

    /// Judges a command and begins it; returns the ticket of what the vehicle does.
    fn carry_out(
        &mut self,
        peer: Peer,
        received: &Received,
        now: Now,
    ) -> Result<Option<u32>, Refusal> {
        let Some(row) = row_of(received.number) else {
            let why = format!("command {} is not supported", received.number);
            return Err((MavResult::MAV_RESULT_UNSUPPORTED, why));
        };
        if row.controls && row.number != 32_100 && !self.control.permits(peer) {
            let why = format!(
                "station {} is in control",
                self.control.owner().unwrap_or(0)
            );
            return Err((MavResult::MAV_RESULT_NOT_IN_CONTROL, why));
        }
        let situation = Situation {
            state: &self.state,
            missions: &self.missions,
        };
        match row.judge(received, &situation)? {
            Todo::Nothing => Ok(None),
            Todo::Protocol(of) => self.of_protocol(peer, of, now).map(|()| None),
            Todo::Vehicle(_) if !self.state.is_connected || !self.commands.has_room() => {
                let why = "there is no fccd that could do it now".to_owned();
                Err((MavResult::MAV_RESULT_TEMPORARILY_REJECTED, why))
            }
            Todo::Vehicle(commands) => {
                let action = Action::Commands(commands);
                Ok(Some(self.fx.request(peer, action, now)))
            }
        }
    }

    fn of_protocol(&mut self, peer: Peer, of: OfProtocol, now: Now) -> Result<(), Refusal> {
        let no_message = |number: u32| {
            let why = format!("message {number} is not sent");
            (MavResult::MAV_RESULT_UNSUPPORTED, why)
        };
        match of {
            OfProtocol::Message(number, index) => {
                let bodies = if number == id::CONTROL_STATUS {
                    self.control.status().into_iter().collect()
                } else {
                    requested(number, index, &self.scene(now))
                };
                if bodies.is_empty() {
                    return Err(no_message(number));
                }
                for body in bodies {
                    self.fx.answer(peer, body);
                }
            }
            OfProtocol::Interval(number, us) => {
                let streams = self.links.streams(peer.link);
                if !streams.is_some_and(|streams| streams.set(number, us)) {
                    return Err((MavResult::MAV_RESULT_DENIED, no_message(number).1));
                }
            }
            OfProtocol::TellInterval(number) => {
                let streams = self.links.streams(peer.link);
                let interval_us = streams.and_then(|streams| streams.interval_us(number));
                let interval = MESSAGE_INTERVAL_DATA {
                    // 0: it is not supported.
                    interval_us: interval_us.unwrap_or(0),
                    message_id: number as u16,
                };
                self.fx.answer(peer, MavMessage::MESSAGE_INTERVAL(interval));
            }
            OfProtocol::Start(item) => self.missions.set_start(item),
            OfProtocol::Choose(mode) => {
                self.has_chosen = mode == Mode::Plan;
                self.state.flight.mode = mode;
            }
            OfProtocol::Operator { takes, takeover } => {
                self.control.request(peer, (takes, takeover), now)?;
            }
            OfProtocol::HighLatency(is_on) => {
                if let Some(streams) = self.links.streams(peer.link) {
                    streams.is_high_latency = is_on;
                }
            }
        }
        Ok(())
    }
}

/// How important an event is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Severity {
    /// Something has failed that the flight needs.
    Critical,
    /// Something is wrong.
    Warning,
    /// Something has changed.
    Notice,
    /// For information.
    Info,
}

fn timesync(peer: Peer, frame: &Frame, now: Now) -> TIMESYNC_DATA {
    TIMESYNC_DATA {
        tc1: (now.utc_us * 1_000).cast_signed(),
        ts1: frame.payload.i64(8),
        target_system: peer.system,
        target_component: peer.component,
    }
}

/// Every request for files is refused at once (`MAVLink FTP`: NAK, file not found), so that
/// stations ask for parameters the usual way.
fn no_files(peer: Peer, frame: &Frame) -> Body {
    const NAK: u8 = 129;
    const FILE_NOT_FOUND: u8 = 10;
    let [sequence_low, sequence_high, session, opcode] = frame.payload.bytes(3);
    let sequence = u16::from_le_bytes([sequence_low, sequence_high]).wrapping_add(1);
    let mut payload = vec![0];
    payload.extend(peer.address());
    payload.extend(sequence.to_le_bytes());
    payload.extend([session, NAK, 1, opcode, 0, 0, 0, 0, 0, 0, FILE_NOT_FOUND]);
    Body::raw(110, 84, &payload)
}
