//! How much is sent to X-Plane.
//!
//! X-Plane takes about 140 messages a frame and loses the rest (P. Münzel,
//! Laminar Research, pull request 3 of github.com/charlylima/XPlaneUDP, 2017).
//! Its longest regular frame lasts a twentieth of a second: with fewer frames
//! its time slows down. So the writes of the controls and the requests are
//! limited by time, each to its share of such a frame, and a quarter is left for
//! frames that come late. A loop of up to 100 Hz writes in every tick, whatever
//! the number of engines; more often than it draws, X-Plane reads nothing.

use core::time::Duration;

use fcc_core::framework::Time;

/// X-Plane takes about as many messages in a frame.
#[cfg(test)]
const MESSAGES_PER_FRAME: usize = 140;
/// The longest frame at which X-Plane's time is not slow, and the longest for
/// which the writes are spread further.
const FRAME: Duration = Duration::from_millis(50);
const LONGEST_FRAME: Duration = Duration::from_millis(250);
/// The share of the controls.
const WRITES_PER_FRAME: f64 = 60.0;

/// The requests sent together, and the interval between two of such portions:
/// at most three portions in a frame.
pub(crate) const REQUESTS_PER_PORTION: usize = 7;
const PORTION_EVERY: Duration = Duration::from_millis(20);

/// Spreads the writes of the controls.
#[derive(Clone, Debug)]
pub(crate) struct WritePace {
    last: Time,
}

impl WritePace {
    pub(crate) const fn begin() -> Self {
        Self { last: Time::NEVER }
    }

    /// Whether `messages` may be sent now; if so, they count as sent.
    /// `frame_s` is the simulator's present frame period.
    pub(crate) fn take(&mut self, now: Time, messages: usize, frame_s: f64) -> bool {
        let frame_s = frame_s.clamp(FRAME.as_secs_f64(), LONGEST_FRAME.as_secs_f64());
        let interval_s = messages as f64 * frame_s / WRITES_PER_FRAME;
        let is_due = now.since(self.last).as_secs_f64() >= interval_s;
        if is_due {
            self.last = now;
        }
        is_due
    }
}

/// Spreads the requests.
#[derive(Clone, Debug)]
pub(crate) struct RequestPace {
    last: Time,
}

impl RequestPace {
    pub(crate) const fn begin() -> Self {
        Self { last: Time::NEVER }
    }

    /// Whether a portion may be sent now.
    pub(crate) fn is_due(&self, now: Time) -> bool {
        now.since(self.last) >= PORTION_EVERY
    }

    /// A portion was sent.
    pub(crate) fn sent(&mut self, now: Time) {
        self.last = now;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a loop of this rate: how many of its writes are sent in a second.
    fn writes(rate_hz: i64, messages: usize, frame_s: f64) -> usize {
        let mut pace = WritePace::begin();
        (0..rate_hz)
            .filter(|tick| {
                let now = Time::from_nanos(1_000_000_000 * (1 + tick / rate_hz))
                    + Duration::from_nanos((tick % rate_hz * 1_000_000_000 / rate_hz) as u64);
                pace.take(now, messages, frame_s)
            })
            .count()
    }

    #[test]
    fn a_fast_loop_writes_less_often_and_a_usual_one_in_every_tick() {
        for messages in [1, 4, 11] {
            assert_eq!(writes(40, messages, 0.016), 40);
            assert_eq!(writes(100, messages, 0.016), 100);
        }
        // 60 messages in 50 ms are 4 every 3.3 ms: every fourth tick.
        assert_eq!(writes(1_000, 4, 0.016), 250);
        assert!(writes(1_000, 11, 0.016) * 11 <= 1_200);
        // At ten frames a second, 60 in 100 ms.
        assert!(writes(1_000, 4, 0.1) * 4 <= 600);
    }

    #[test]
    fn writes_and_requests_fill_three_quarters_of_a_frame_at_most() {
        let portions = FRAME.as_millis().div_ceil(PORTION_EVERY.as_millis()) as usize;
        let overrides = 2;
        // Three surfaces and two overrides, three times.
        let release = 15;
        let all = WRITES_PER_FRAME as usize + portions * REQUESTS_PER_PORTION + overrides + release;
        assert!(all * 4 <= MESSAGES_PER_FRAME * 3, "{all}");
    }
}
