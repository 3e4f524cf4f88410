//! MAVLink: any bytes, and frames of any message that is read, of several stations, on a link
//! of datagrams and on one of bytes. No panic; with a key, nothing is carried out or answered
//! that is not signed, or is signed and comes again.
//!
//! The first byte chooses key, flight and identity. Then pieces: their kind, sender, length,
//! and as many bytes; of a frame the first is its message, by its place in `IDS`.
#![no_main]

use fcc_mavlink::{
    Action, Flight, Identity, Key, LinkOptions, Mode, Motion, Now, Parameter, Position, Protocol,
    Settings, VehicleState,
};
use fcc_plan::Plan;
use mavlink::dialects::common::MavMessage;
use mavlink::{Message as _, calculate_crc};
use sha2::{Digest as _, Sha256};

const KEY: [u8; 32] = [0x5A; 32];
/// 2026-11-29, and 2015-01-01, from which time stamps count 10 µs.
const UTC_US: u64 = 1_795_900_000_000_000;
const EPOCH_US: u64 = 1_420_070_400_000_000;
/// All that are read, and one that is not.
const IDS: [u8; 22] = [
    0, 11, 20, 21, 23, 38, 39, 40, 41, 43, 44, 45, 47, 51, 73, 75, 76, 110, 111, 126, 69, 4,
];
const SENDERS: [[u8; 2]; 4] = [[255, 190], [42, 190], [255, 1], [1, 1]];
const COMMAND_ACK: u8 = 77;

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Bytes,
    V1,
    Unsigned,
    Signed,
    Forged,
    Again,
}

const FORMS: [Form; 8] = [
    Form::Unsigned,
    Form::Signed,
    Form::Unsigned,
    Form::Signed,
    Form::Bytes,
    Form::V1,
    Form::Forged,
    Form::Again,
];

struct World {
    protocol: Protocol,
    state: VehicleState,
    plan: Plan,
    now: Now,
    has_key: bool,
    /// A frame that was signed has been there: from then on answers may come.
    is_signed: bool,
    sequence: u8,
    last: Vec<u8>,
}

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((first, mut rest)) = input.split_first() else {
        return;
    };
    let mut world = World::new(*first);
    while let [kind, sender, length, left @ ..] = rest {
        let (body, left) = left.split_at(usize::from(*length).min(left.len()));
        rest = left;
        world.take(*kind, *sender, body);
    }
    world.step(500, false);
});

impl World {
    fn new(choice: u8) -> Self {
        let now = Now { ms: 0, utc_us: UTC_US };
        let has_key = choice & 1 != 0;
        let identity = if choice & 2 != 0 { Identity::Px4 } else { Identity::Generic };
        let key = has_key.then_some(Key(KEY));
        let settings = Settings { system: 1, identity, key, newest_time_stamp: 0 };
        let mut protocol = Protocol::new(settings, now);
        for (link, is_datagram) in [(1, true), (2, false)] {
            let is_high_latency = choice & 4 != 0;
            let options = LinkOptions { bytes_per_s: 5_760.0, is_datagram, is_high_latency };
            protocol.open(link, options, now);
        }
        let parameter = |name, setpoint| Parameter { name, value: 1_013.25, origin: String::new(), setpoint };
        protocol.set_parameters(vec![
            parameter("QNH_HPA", Some(("altimeter_setting_pa", 100.0))),
            parameter("SPD_STALL_MPS", None),
        ]);
        let place = Position { latitude_rad: 0.8, longitude_rad: 0.2, altitude_m: 400.0 };
        let mut state = VehicleState {
            is_connected: choice & 8 == 0,
            motion: Motion { position: Some(place), ..Motion::default() },
            ..VehicleState::default()
        };
        state.health.may_engage = true;
        if choice & 16 != 0 {
            state.home = Some(place);
            let mode = if choice & 32 != 0 { Mode::Hold } else { Mode::Plan };
            let flight = Flight { mode, item: 1, altitude_m: 700.0, ..Flight::default() };
            state.flight = Flight { is_engaged: true, is_airborne: true, ..flight };
        }
        protocol.set_state(state);
        let (plan, last) = (Plan::default(), Vec::new());
        Self { protocol, state, plan, now, has_key, is_signed: false, sequence: 0, last }
    }

    fn take(&mut self, kind: u8, sender: u8, body: &[u8]) {
        let form = FORMS[usize::from(kind % 8)];
        let bytes = match form {
            Form::Bytes => body.to_vec(),
            Form::Again => self.last.clone(),
            _ => self.frame(form, sender, kind & 8 != 0, body),
        };
        let link = 1 + u16::from(kind >> 4 & 1);
        let is_silent = self.has_key && form != Form::Signed;
        self.protocol.receive(link, &bytes, self.now);
        let asked = self.asked();
        assert!(asked == 0 || !is_silent, "{asked} by what was not signed");
        self.is_signed |= form == Form::Signed;
        self.last = bytes;
        let later_ms = [0, 10, 300, 5_000][usize::from(kind >> 6)];
        self.step(later_ms, kind & 32 != 0);
    }

    /// A frame with the right checksum.
    fn frame(&mut self, form: Form, sender: u8, is_repeated: bool, body: &[u8]) -> Vec<u8> {
        let (message, payload) = body.split_first().unwrap_or((&0, &[]));
        let id = IDS[usize::from(*message) % IDS.len()];
        let [system, component] = SENDERS[usize::from(sender % 4)];
        if !is_repeated {
            self.sequence = self.sequence.wrapping_add(1);
        }
        let has_signature = matches!(form, Form::Signed | Form::Forged);
        let (length, sequence) = (payload.len() as u8, self.sequence);
        let mut bytes = match form {
            Form::V1 => vec![0xFE, length, sequence, system, component, id],
            _ => vec![0xFD, length, has_signature.into(), 0, sequence, system, component, id, 0, 0],
        };
        bytes.extend(payload);
        let crc = calculate_crc(&bytes[1..], MavMessage::extra_crc(id.into()));
        bytes.extend(crc.to_le_bytes());
        if has_signature {
            // Each is later than those before.
            self.now.utc_us += 10;
            bytes.push(sender >> 2);
            bytes.extend(&((self.now.utc_us - EPOCH_US) / 10).to_le_bytes()[..6]);
            let key = if form == Form::Signed { KEY } else { [0x5B; 32] };
            let hash = Sha256::new().chain_update(key).chain_update(&bytes).finalize();
            bytes.extend(&hash[..6]);
        }
        bytes
    }

    /// Carries out what is asked for, or refuses it; returns how much that was.
    fn asked(&mut self) -> usize {
        let requests = self.protocol.requests();
        for request in &requests {
            let outcome = match &request.action {
                _ if self.sequence % 8 == 7 => Err("not now".to_owned()),
                Action::Commands(commands) => {
                    assert!(!commands.is_empty());
                    Ok(0)
                }
                Action::Plan { plan, item } => {
                    assert!(*item >= 1);
                    self.plan = (**plan).clone();
                    Ok(plan.hash().first_64_bits())
                }
            };
            if let Ok(hash @ 1..) = outcome {
                self.state.plan_hash = hash;
                self.protocol.set_state(self.state);
            }
            self.protocol.finish(request.ticket, &outcome);
        }
        requests.len()
    }

    fn step(&mut self, later_ms: u64, tells_plan: bool) {
        self.now.ms += later_ms;
        self.now.utc_us += 1_000 * later_ms;
        if tells_plan {
            self.protocol.set_plan(self.state.plan_hash, Some(&self.plan));
        }
        let (mut sent, mut acks) = (0, 0);
        self.protocol.step(self.now, |_, frame| {
            assert_eq!(frame[0], 0xFD);
            sent += frame.len();
            acks += usize::from(frame[7..10] == [COMMAND_ACK, 0, 0]);
        });
        let asked = self.asked();
        assert!(!self.has_key || self.is_signed || acks + asked == 0);
        assert!(sent < 100_000, "{sent} bytes at once");
    }
}
