//! How often each message is sent on a link.

use crate::message::id;

/// Messages that are sent by themselves, and how often, ms.
const USUAL: [(u32, u64); 15] = [
    (id::ATTITUDE, 100),
    (id::GLOBAL_POSITION_INT, 200),
    (id::VFR_HUD, 250),
    (id::GPS_RAW_INT, 500),
    (id::NAV_CONTROLLER_OUTPUT, 500),
    (id::SYS_STATUS, 1_000),
    (id::SYSTEM_TIME, 1_000),
    (id::EXTENDED_SYS_STATE, 1_000),
    (id::MISSION_CURRENT, 1_000),
    (id::WIND_COV, 1_000),
    (id::CONTROL_STATUS, 1_000),
    (id::CURRENT_MODE, 2_000),
    (id::HOME_POSITION, 5_000),
    (id::AVAILABLE_MODES_MONITOR, 10_000),
    (id::HIGH_LATENCY2, 0),
];
/// No message is sent more often, ms: state comes at 50 Hz.
const SHORTEST_MS: u64 = 20;
/// Where a satellite is in between.
const HIGH_LATENCY_MS: u64 = 5_000;

/// The rates of one link.
#[derive(Debug)]
pub(crate) struct Streams {
    streams: Vec<Stream>,
    pub(crate) is_high_latency: bool,
}

#[derive(Debug)]
struct Stream {
    number: u32,
    /// 0: never.
    every_ms: u64,
    due_ms: u64,
}

impl Streams {
    pub(crate) fn new(is_high_latency: bool) -> Self {
        let streams = USUAL.iter().map(|(number, every_ms)| Stream {
            number: *number,
            every_ms: *every_ms,
            due_ms: 0,
        });
        Self {
            streams: streams.collect(),
            is_high_latency,
        }
    }

    /// Changes how often a message is sent, µs; -1: never, 0: the usual. Whether there is
    /// such a message.
    pub(crate) fn set(&mut self, number: u32, us: i32) -> bool {
        let usual = USUAL.iter().find(|(known, _)| *known == number);
        let stream = self.streams.iter_mut().find(|one| one.number == number);
        let (Some((_, usual_ms)), Some(stream)) = (usual, stream) else {
            return false;
        };
        stream.every_ms = match u64::try_from(us) {
            Err(_) => 0,
            Ok(0) => *usual_ms,
            Ok(us) => (us / 1_000).max(SHORTEST_MS),
        };
        true
    }

    /// How often a message is sent, µs; -1: never; none: there is no such message.
    pub(crate) fn interval_us(&self, number: u32) -> Option<i32> {
        let stream = self.streams.iter().find(|one| one.number == number)?;
        Some(match stream.every_ms {
            0 => -1,
            ms => i32::try_from(ms * 1_000).unwrap_or(i32::MAX),
        })
    }

    /// The message that waits longest, measured by its own interval. On a link that is too
    /// slow for all, all become slower by the same share.
    pub(crate) fn due(&mut self, now_ms: u64) -> Option<u32> {
        let is_high_latency = self.is_high_latency;
        let waiting = self.streams.iter_mut().filter_map(|stream| {
            let every_ms = match (is_high_latency, stream.number) {
                (true, id::HIGH_LATENCY2) => HIGH_LATENCY_MS,
                (true, _) => 0,
                (false, _) => stream.every_ms,
            };
            let late_ms = now_ms.checked_sub(stream.due_ms)?;
            (every_ms > 0).then(|| (late_ms as f64 / every_ms as f64, every_ms, stream))
        });
        let (late, every_ms, stream) = waiting.max_by(|a, b| a.0.total_cmp(&b.0))?;
        // What was missed is not sent later.
        stream.due_ms = if late < 1.0 {
            stream.due_ms + every_ms
        } else {
            now_ms + every_ms
        };
        Some(stream.number)
    }
}
