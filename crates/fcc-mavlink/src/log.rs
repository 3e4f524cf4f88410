//! Recordings, in pieces (MAVLink's `common.xml`: `LOG_REQUEST_LIST` to `LOG_REQUEST_END`).

use core::mem::take;

use mavlink::dialects::common::{LOG_ENTRY_DATA, MavMessage, MavSeverity};

use crate::effects::{Effects, Peer};
use crate::frame::{Body, Fields};
use crate::vehicle::LinkId;

/// Bytes of a piece.
const PIECE: usize = 90;
/// Pieces that are read at once.
const PIECES: u32 = 128;
/// `LOG_DATA` and its `CRC_EXTRA`.
const DATA: (u32, u8) = (120, 134);

/// A recording. Its number is its place in the list, from 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Log {
    /// When it began, or was written last, s since 1970, UTC.
    pub utc_s: u32,
    /// Its size, or the most that has a number.
    pub bytes: u32,
}

/// What is needed from who owns the files; answered by [`Protocol`](crate::Protocol).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LogWanted {
    /// All recordings, the oldest first.
    List,
    /// Bytes of one.
    Data {
        /// Its number, from 1.
        log: u16,
        /// From here on.
        at: u32,
        /// So many; fewer at its end.
        bytes: u32,
    },
}

/// The recordings, and who is reading them: one station at a time.
#[derive(Debug, Default)]
pub(crate) struct Logs {
    /// None: they are being listed.
    all: Option<Vec<Log>>,
    wants_list: bool,
    wanted: Option<LogWanted>,
    /// A list that waits for its content, or is being sent: to whom, the next one, the last.
    list: Option<(LinkId, u16, u16)>,
    reading: Option<Reading>,
}

#[derive(Debug)]
struct Reading {
    link: LinkId,
    log: u16,
    at: u32,
    end: u32,
    /// Bytes from `at` on; none: they are being read.
    block: Option<Vec<u8>>,
}

impl Logs {
    /// What is needed, once.
    pub(crate) fn wanted(&mut self) -> Option<LogWanted> {
        if take(&mut self.wants_list) {
            return Some(LogWanted::List);
        }
        self.wanted.take()
    }

    pub(crate) fn set_all(&mut self, all: Vec<Log>) {
        if let Some((_, _, last)) = &mut self.list {
            *last = (*last).min(all.len().max(1) as u16);
        }
        self.all = Some(all);
    }

    /// Bytes that were wanted; fewer at the end of the recording.
    pub(crate) fn set_data(&mut self, log: u16, at: u32, bytes: Vec<u8>) {
        let reading = self.reading.as_mut();
        if let Some(reading) = reading.filter(|one| (one.log, one.at) == (log, at)) {
            reading.block = Some(bytes);
        }
    }

    /// Takes a message from `LOG_REQUEST_LIST` to `LOG_REQUEST_END`.
    pub(crate) fn take(&mut self, peer: Peer, id: u32, fields: &Fields, fx: &mut Effects) {
        match id {
            117 => {
                self.list = Some((peer.link, fields.u16(0).max(1), fields.u16(2)));
                self.all = None;
                self.wants_list = true;
            }
            119 => {
                let log = fields.u16(8);
                if self
                    .reading
                    .as_ref()
                    .is_some_and(|one| one.link != peer.link)
                {
                    let why = "another station is reading a recording: try again";
                    return fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
                }
                let (at, count) = (fields.u32(0), fields.u32(4));
                self.reading = Some(Reading {
                    link: peer.link,
                    log,
                    at,
                    end: at.saturating_add(count),
                    block: None,
                });
                self.want(log, at);
            }
            121 => {
                let why = "recordings are deleted by the page, or on the board";
                fx.tell(peer, MavSeverity::MAV_SEVERITY_WARNING, why);
            }
            _ => self.forget(peer.link),
        }
    }

    const fn want(&mut self, log: u16, at: u32) {
        let bytes = PIECE as u32 * PIECES;
        self.wanted = Some(LogWanted::Data { log, at, bytes });
    }

    /// The next message for a link.
    pub(crate) fn next(&mut self, link: LinkId) -> Option<Body> {
        self.entry(link).or_else(|| self.piece(link))
    }

    fn entry(&mut self, link: LinkId) -> Option<Body> {
        let (_, next, last) = self.list.as_mut().filter(|list| list.0 == link)?;
        let all = self.all.as_ref()?;
        let count = all.len() as u16;
        let log = usize::from(*next).checked_sub(1).and_then(|at| all.get(at));
        let entry = LOG_ENTRY_DATA {
            time_utc: log.map_or(0, |log| log.utc_s),
            size: log.map_or(0, |log| log.bytes),
            // 0 and no log: there is none.
            id: log.map_or(0, |_| *next),
            num_logs: count,
            last_log_num: count,
        };
        *next += 1;
        if *next > *last {
            self.list = None;
        }
        Some(Body::from(MavMessage::LOG_ENTRY(entry)))
    }

    /// A piece that is not full is the last of a recording.
    fn piece(&mut self, link: LinkId) -> Option<Body> {
        let reading = self.reading.as_mut().filter(|one| one.link == link)?;
        let block = reading.block.as_mut()?;
        let left = (reading.end - reading.at) as usize;
        let count = block.len().min(PIECE).min(left);
        let mut payload = reading.at.to_le_bytes().to_vec();
        payload.extend(reading.log.to_le_bytes());
        payload.push(count as u8);
        payload.extend(block.drain(..count));
        reading.at += count as u32;
        let is_last = count < PIECE || reading.at == reading.end;
        if is_last {
            self.reading = None;
        } else if block.is_empty() {
            reading.block = None;
            let (log, at) = (reading.log, reading.at);
            self.want(log, at);
        }
        Some(Body::raw(DATA.0, DATA.1, &payload))
    }

    /// A link has ended, or wants no more.
    pub(crate) fn forget(&mut self, link: LinkId) {
        self.list = self.list.filter(|list| list.0 != link);
        self.reading = self.reading.take().filter(|one| one.link != link);
    }
}
