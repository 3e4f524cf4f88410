//! What became of commands: each has exactly one final answer, and is carried out once.

use std::collections::BTreeMap;

use mavlink::dialects::common::{MavResult, MavSeverity};

use crate::command::{Received, Refusal};
use crate::effects::{Effects, Peer};
use crate::frame::Body;
use crate::vehicle::{Now, Outcome};

type Code = MavResult;

/// What takes longer is in progress first, and again every so often, ms: in time for MAVSDK,
/// which sends again after 500 ms, and seldom, for its missions take that for a failure.
const IN_PROGRESS_MS: u64 = 400;
/// Of these the vehicle refuses the value, which is the same when it is sent again.
const OF_VALUES: [u16; 6] = [178, 186, 192, 43_000, 43_001, 43_002];
const AGAIN_MS: u64 = 1_000;
/// A frame that comes twice, or is sent again with a higher `confirmation`, ms.
const REPEATED_MS: u64 = 5_000;
/// `COMMAND_INT` does not say that it is sent again: the same within this time is, ms. In it
/// frames overtake each other, too.
const SAME_MS: u64 = 1_000;
/// Commands that are being carried out, and senders that are remembered.
const MOST_RUNNING: usize = 16;
const MOST_SENDERS: usize = 32;
const PROGRESS_UNKNOWN: u8 = 255;

/// Commands that are being carried out, and the last one of each sender.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    running: Vec<Running>,
    last: BTreeMap<Peer, Last>,
}

#[derive(Debug)]
struct Running {
    ticket: u32,
    peer: Peer,
    number: u16,
    tell_ms: u64,
}

#[derive(Debug)]
struct Last {
    bytes: [u8; 36],
    number: u16,
    sequence: u8,
    at_ms: u64,
    /// None: it is being carried out.
    result: Option<Code>,
}

impl Commands {
    /// Whether a command is to be judged; one that was, and one that is late, is answered.
    pub(crate) fn begin(
        &mut self,
        (peer, sequence): (Peer, u8),
        received: &Received,
        now: Now,
        fx: &mut Effects,
    ) -> bool {
        let known = self.last.get(&peer);
        let known = known.filter(|last| now.ms < last.at_ms + REPEATED_MS);
        if let Some(last) = known {
            let since_ms = now.ms - last.at_ms;
            let is_int = received.bytes[35] == 35;
            let is_again = last.sequence == sequence
                || received.confirmation > 0
                || (is_int && since_ms < SAME_MS)
                || last.result.is_none();
            if last.bytes == received.bytes && is_again {
                let result = last.result.unwrap_or(Code::MAV_RESULT_IN_PROGRESS);
                fx.answer(peer, ack(peer, received.number, result));
                return false;
            }
            let is_older = sequence.wrapping_sub(last.sequence).cast_signed() < 0;
            if is_older && since_ms < SAME_MS {
                let code = Code::MAV_RESULT_TEMPORARILY_REJECTED;
                fx.answer(peer, ack(peer, received.number, code));
                let why = "it arrived behind a later command: send it again";
                fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
                return false;
            }
        }
        if self.last.len() >= MOST_SENDERS && !self.last.contains_key(&peer) {
            let oldest = self.last.iter().min_by_key(|(_, last)| last.at_ms);
            if let Some(oldest) = oldest.map(|(peer, _)| *peer) {
                self.last.remove(&oldest);
            }
        }
        let last = Last {
            bytes: received.bytes,
            number: received.number,
            sequence,
            at_ms: now.ms,
            result: None,
        };
        self.last.insert(peer, last);
        true
    }

    /// Whether one more can be carried out.
    pub(crate) fn has_room(&self) -> bool {
        self.running.len() < MOST_RUNNING
    }

    /// A command is being carried out.
    pub(crate) fn run(&mut self, ticket: u32, peer: Peer, number: u16, now: Now) {
        self.running.push(Running {
            ticket,
            peer,
            number,
            tell_ms: now.ms + IN_PROGRESS_MS,
        });
    }

    /// The final answer.
    pub(crate) fn end(
        &mut self,
        peer: Peer,
        number: u16,
        result: &Result<(), Refusal>,
        fx: &mut Effects,
    ) {
        let code = match result {
            Ok(()) => Code::MAV_RESULT_ACCEPTED,
            Err((code, _)) => *code,
        };
        if let Some(last) = self
            .last
            .get_mut(&peer)
            .filter(|last| last.number == number)
        {
            last.result = Some(code);
        }
        fx.answer(peer, ack(peer, number, code));
        // Stations try what a vehicle supports: a text for each would hide the others.
        if let Err((_, why)) = result
            && code != Code::MAV_RESULT_UNSUPPORTED
        {
            fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
        }
    }

    /// What became of a ticket.
    pub(crate) fn finish(&mut self, ticket: u32, outcome: &Outcome, fx: &mut Effects) {
        let at = self.running.iter().position(|one| one.ticket == ticket);
        let Some(running) = at.map(|at| self.running.remove(at)) else {
            return;
        };
        let code = if OF_VALUES.contains(&running.number) {
            Code::MAV_RESULT_DENIED
        } else {
            Code::MAV_RESULT_TEMPORARILY_REJECTED
        };
        let refused = |why: &String| (code, why.clone());
        let result = outcome.as_ref().map(|_| ()).map_err(refused);
        self.end(running.peer, running.number, &result, fx);
    }

    /// Says that commands are in progress.
    pub(crate) fn step(&mut self, now: Now, fx: &mut Effects) {
        for running in &mut self.running {
            if now.ms >= running.tell_ms {
                running.tell_ms = now.ms + AGAIN_MS;
                let code = Code::MAV_RESULT_IN_PROGRESS;
                fx.answer(running.peer, ack(running.peer, running.number, code));
            }
        }
    }
}

/// `COMMAND_ACK`.
fn ack(peer: Peer, number: u16, code: Code) -> Body {
    let mut payload = number.to_le_bytes().to_vec();
    let progress = match code {
        Code::MAV_RESULT_IN_PROGRESS => PROGRESS_UNKNOWN,
        _ => 0,
    };
    payload.extend([code as u8, progress, 0, 0, 0, 0]);
    payload.extend(peer.address());
    Body::raw(77, 143, &payload)
}
