//! What a step of the protocol wants to happen.

use mavlink::dialects::common::{MavMessage, MavSeverity, STATUSTEXT_DATA};

use crate::frame::Body;
use crate::vehicle::{Action, LinkId, Now, Request};

/// A ground station, or another component, on a link.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) struct Peer {
    pub(crate) link: LinkId,
    pub(crate) system: u8,
    pub(crate) component: u8,
}

impl Peer {
    /// The two bytes that address it.
    pub(crate) const fn address(self) -> [u8; 2] {
        [self.system, self.component]
    }
}

/// A command that is not carried out within this time is not carried out later, ms: stations
/// give up after 3 s.
const CARRIED_OUT_WITHIN_MS: u64 = 3_000;
/// Texts of one refusal: frames of 50 bytes.
const MOST_CHUNKS: usize = 4;
const CHUNK_BYTES: usize = 50;

/// What is to be sent and done.
#[derive(Debug, Default)]
pub(crate) struct Effects {
    pub(crate) answers: Vec<(LinkId, Body)>,
    /// To all links.
    pub(crate) broadcasts: Vec<Body>,
    pub(crate) requests: Vec<Request>,
    tickets: u32,
    texts: u16,
}

impl Effects {
    pub(crate) fn answer(&mut self, peer: Peer, body: impl Into<Body>) {
        self.answers.push((peer.link, body.into()));
    }

    /// Wants something done; returns the ticket of its outcome.
    pub(crate) fn request(&mut self, peer: Peer, action: Action, now: Now) -> u32 {
        self.tickets = self.tickets.wrapping_add(1);
        self.requests.push(Request {
            ticket: self.tickets,
            link: peer.link,
            sender: (peer.system, peer.component),
            deadline_ms: now.ms + CARRIED_OUT_WITHIN_MS,
            action,
        });
        self.tickets
    }

    /// A text for the one who asked.
    pub(crate) fn tell(&mut self, peer: Peer, severity: MavSeverity, text: &str) {
        let bodies = self.text(severity, text);
        self.answers
            .extend(bodies.into_iter().map(|body| (peer.link, body)));
    }

    /// A text for everybody.
    pub(crate) fn announce(&mut self, severity: MavSeverity, text: &str) {
        let bodies = self.text(severity, text);
        self.broadcasts.extend(bodies);
    }

    /// What does not fit into one message is sent in several with the same number.
    fn text(&mut self, severity: MavSeverity, text: &str) -> Vec<Body> {
        let plain: Vec<u8> = text
            .chars()
            .map(|c| match c {
                ' '..='~' => c as u8,
                '°' => b'd',
                _ => b'?',
            })
            .take(MOST_CHUNKS * CHUNK_BYTES)
            .collect();
        self.texts = self.texts.wrapping_add(1).max(1);
        let id = if plain.len() > CHUNK_BYTES {
            self.texts
        } else {
            0
        };
        let chunks = plain.chunks(CHUNK_BYTES).enumerate();
        chunks
            .map(|(n, chunk)| {
                let mut padded = [0; CHUNK_BYTES];
                for (to, from) in padded.iter_mut().zip(chunk) {
                    *to = *from;
                }
                Body::from(MavMessage::STATUSTEXT(STATUSTEXT_DATA {
                    severity,
                    text: mavlink::types::CharArray::new(padded),
                    id,
                    chunk_seq: n as u8,
                }))
            })
            .collect()
    }
}
