//! Links: what arrives on each, and what is sent, within its rate.

use std::collections::{BTreeMap, VecDeque};

use crate::frame::{Body, Deframer, Frame};
use crate::log::Logs;
use crate::message::{Scene, body, id};
use crate::parameter::Parameters;
use crate::signing::Signing;
use crate::streams::Streams;
use crate::vehicle::LinkId;
use crate::vehicle::Now;

/// The component that speaks: `MAV_COMP_ID_AUTOPILOT1`.
pub(crate) const COMPONENT: u8 = 1;
/// Answers that wait for a slow link.
const MOST_ANSWERS: usize = 256;
/// Telemetry leaves this for answers, bytes: a frame of the longest.
const RESERVE_BYTES: f64 = 280.0;
const HEARTBEAT_MS: u64 = 1_000;

/// What a link is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LinkOptions {
    /// Bytes that it carries in a second.
    pub bytes_per_s: f64,
    /// Whether bytes come as whole datagrams.
    pub is_datagram: bool,
    /// Only `HIGH_LATENCY2` is sent by itself.
    pub is_high_latency: bool,
}

#[derive(Debug)]
struct Link {
    options: LinkOptions,
    deframer: Deframer,
    streams: Streams,
    answers: VecDeque<Body>,
    sequence: u8,
    /// Bytes that may be sent now, and those of parameters and recordings: half of them.
    budget: f64,
    list_budget: f64,
    refilled_ms: u64,
    heartbeat_ms: u64,
}

/// All links.
#[derive(Debug, Default)]
pub(crate) struct Links(BTreeMap<LinkId, Link>);

impl Links {
    pub(crate) fn open(&mut self, link: LinkId, options: LinkOptions, now: Now) {
        let opened = Link {
            options,
            deframer: Deframer::default(),
            streams: Streams::new(options.is_high_latency),
            answers: VecDeque::new(),
            sequence: 0,
            budget: options.bytes_per_s,
            list_budget: 0.0,
            refilled_ms: now.ms,
            heartbeat_ms: now.ms,
        };
        self.0.insert(link, opened);
    }

    pub(crate) fn close(&mut self, link: LinkId) {
        self.0.remove(&link);
    }

    /// The frames in what has arrived.
    pub(crate) fn frames(&mut self, link: LinkId, bytes: &[u8]) -> Vec<Frame> {
        let mut frames = Vec::new();
        if let Some(link) = self.0.get_mut(&link) {
            link.deframer.push(bytes, |frame| frames.push(frame));
            if link.options.is_datagram {
                link.deframer.clear();
            }
        }
        frames
    }

    pub(crate) fn streams(&mut self, link: LinkId) -> Option<&mut Streams> {
        self.0.get_mut(&link).map(|link| &mut link.streams)
    }

    /// Queues an answer; what does not fit is lost, as on the link itself.
    pub(crate) fn answer(&mut self, link: LinkId, body: Body) {
        if let Some(link) = self.0.get_mut(&link)
            && link.answers.len() < MOST_ANSWERS
        {
            link.answers.push_back(body);
        }
    }

    pub(crate) fn broadcast(&mut self, body: &Body) {
        let all: Vec<LinkId> = self.0.keys().copied().collect();
        for link in all {
            self.answer(link, body.clone());
        }
    }

    /// What is sent now.
    pub(crate) fn send(
        &mut self,
        scene: &Scene<'_>,
        control: Option<&Body>,
        (parameters, logs, signing): (&mut Parameters, &mut Logs, &mut Signing),
        mut out: impl FnMut(LinkId, Vec<u8>),
    ) {
        for (number, link) in &mut self.0 {
            link.refill(scene.now);
            while let Some(body) = link.next(*number, scene, control, (parameters, logs)) {
                let signer = signing.signer(*number as u8, scene.now);
                let frame = body.frame((scene.system, COMPONENT), link.sequence, signer);
                link.sequence = link.sequence.wrapping_add(1);
                link.budget -= frame.len() as f64;
                out(*number, frame);
            }
        }
    }
}

impl Link {
    /// A link that was idle carries no more than in one second.
    fn refill(&mut self, now: Now) {
        let seconds = now.ms.saturating_sub(self.refilled_ms) as f64 * 1e-3;
        let bytes = seconds * self.options.bytes_per_s;
        let most = self.options.bytes_per_s.max(RESERVE_BYTES * 2.0);
        self.budget = (self.budget + bytes).min(most);
        self.list_budget = (self.list_budget + bytes / 2.0).min(most / 2.0);
        self.refilled_ms = now.ms;
    }

    /// The next message, by priority: heartbeat, answers, parts of lists, telemetry.
    fn next(
        &mut self,
        number: LinkId,
        scene: &Scene<'_>,
        control: Option<&Body>,
        (parameters, logs): (&mut Parameters, &mut Logs),
    ) -> Option<Body> {
        if self.budget <= 0.0 {
            return None;
        }
        if scene.now.ms >= self.heartbeat_ms && !self.streams.is_high_latency {
            self.heartbeat_ms = scene.now.ms + HEARTBEAT_MS;
            return body(id::HEARTBEAT, scene);
        }
        if let Some(answer) = self.answers.pop_front() {
            return Some(answer);
        }
        if self.list_budget > 0.0
            && let Some(part) = parameters.next(number).or_else(|| logs.next(number))
        {
            self.list_budget -= part.bytes();
            return Some(part);
        }
        while self.budget > RESERVE_BYTES {
            let due = self.streams.due(scene.now.ms)?;
            let found = match due {
                id::CONTROL_STATUS => control.cloned(),
                due => body(due, scene),
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }
}
