//! A source's own clock, mapped to the loop's.

use core::time::Duration;

use super::Time;

/// By how much two clocks with crystals can drift apart, s per s.
const MOST_DRIFT: f64 = 500e-6;
/// By how much the drift can differ from its estimate, s per s. An age that does
/// not change is forgotten at this rate.
const DRIFT_MARGIN: f64 = 50e-6;
/// The drift is that between the fastest samples of two spans of this length, s.
const SPAN_S: f64 = 10.0;
/// The share of a new value in the averages of drift and jitter; that of the
/// jitter is RFC 3550's (section 6.4.1).
const SHARE: f64 = 1.0 / 16.0;

/// Maps the clock of a source to the loop's, and tells how old each sample is
/// when it arrives, relative to the fastest one.
///
/// A source that counts its own time sends it with each sample. The difference
/// between the time of arrival and that time is an unknown constant, the drift of
/// the two clocks, and the delay of the way; the least difference is that of the
/// fastest sample (minimum filter, as in the clock filter of NTP: Mills, RFC 5905,
/// section 10). What is common to all samples cannot be told from the constant: a
/// delay that has been there from the first one is 0 here.
///
/// Samples must arrive in order: an earlier time means that the source's clock was
/// set back or began anew, and is mapped again. Constant cost, no allocation.
///
/// ```
/// use core::time::Duration;
/// use fcc_core::framework::{SourceClock, Time};
///
/// let mut clock = SourceClock::default();
/// let at_ms = |ms: i64| Time::from_nanos(ms * 1_000_000);
/// // A sample each 20 ms takes 3 ms; then a queue holds them for half a second.
/// for n in 0..50 {
///     assert_eq!(clock.step(at_ms(20 * n + 3), 0.020 * n as f64), Duration::ZERO);
/// }
/// let age = clock.step(at_ms(1_000 + 503), 1.0);
/// assert!(age.abs_diff(Duration::from_millis(500)) < Duration::from_millis(1));
/// ```
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct SourceClock {
    /// The first sample, and the last.
    first: Sample,
    last: Sample,
    /// The difference of the fastest sample, s: 0 for that of the first one.
    fastest_s: f64,
    age_s: f64,
    jitter_s: f64,
    drift: f64,
    /// The least difference in this span and in the one before, s, and when this
    /// one began.
    least_s: f64,
    least_before_s: Option<f64>,
    span_began: Time,
}

/// A time of the source and when it arrived.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
struct Sample {
    arrived: Time,
    source_s: f64,
}

impl SourceClock {
    /// Reads a sample that arrived now with a time of the source, s, and returns
    /// its age. A time that is not finite is left out.
    pub fn step(&mut self, arrived: Time, source_s: f64) -> Duration {
        if !source_s.is_finite() {
            return self.age();
        }
        let sample = Sample { arrived, source_s };
        if self.first.arrived.is_never() || source_s < self.last.source_s {
            *self = Self {
                first: sample,
                last: sample,
                span_began: arrived,
                ..Self::default()
            };
            return Duration::ZERO;
        }
        let difference_s =
            arrived.since(self.first.arrived).as_secs_f64() - (source_s - self.first.source_s);
        let passed_s = arrived.since(self.last.arrived).as_secs_f64();
        self.last = sample;
        self.fastest_s += (self.drift + DRIFT_MARGIN) * passed_s;
        self.fastest_s = self.fastest_s.min(difference_s);
        let age_s = difference_s - self.fastest_s;
        self.jitter_s += SHARE * ((age_s - self.age_s).abs() - self.jitter_s);
        self.age_s = age_s;
        self.follow_drift(difference_s);
        self.age()
    }

    fn follow_drift(&mut self, difference_s: f64) {
        self.least_s = self.least_s.min(difference_s);
        let span_s = self.last.arrived.since(self.span_began).as_secs_f64();
        if span_s < SPAN_S {
            return;
        }
        if let Some(before_s) = self.least_before_s {
            let drift = (self.least_s - before_s) / span_s;
            // More is a change of the delay.
            if drift.abs() <= MOST_DRIFT {
                self.drift += SHARE * (drift - self.drift);
            }
        }
        self.least_before_s = Some(self.least_s);
        self.least_s = f64::INFINITY;
        self.span_began = self.last.arrived;
    }

    /// The age of the last sample when it arrived, relative to the fastest one.
    pub fn age(&self) -> Duration {
        Duration::try_from_secs_f64(self.age_s).unwrap_or_default()
    }

    /// The mean difference between the ages of two samples in a row, s: the
    /// interarrival jitter of RFC 3550.
    pub const fn jitter_s(&self) -> f64 {
        self.jitter_s
    }

    /// By how much the source's clock is slower than the loop's, in parts per
    /// million: at most 500.
    pub const fn drift_ppm(&self) -> f64 {
        1e6 * self.drift
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// A source that sends 50 samples a second, by a clock that is slow by `ppm`,
    /// over a way of `delay_s(time)`; each sample's arrival and age, s.
    fn ages_s(ppm: f64, seconds: u32, delay_s: impl Fn(f64) -> f64) -> (SourceClock, Vec<f64>) {
        let mut clock = SourceClock::default();
        let ages = (0..seconds * 50).map(|n| {
            let at_s = f64::from(n) * 0.02;
            let arrived = Time::from_nanos(((at_s + delay_s(at_s)) * 1e9) as i64);
            let source_s = 7_000.0 + at_s * (1.0 - 1e-6 * ppm);
            clock.step(arrived, source_s).as_secs_f64()
        });
        let ages = ages.collect();
        (clock, ages)
    }

    /// A jitter of 0 to 5 ms, the same in each run.
    fn jitter_s(at_s: f64) -> f64 {
        0.005 * (at_s * 7_919.0).fract()
    }

    #[test]
    fn a_clock_that_drifts_by_100_ppm_for_an_hour_is_followed() {
        for ppm in [-100.0, -20.0, 0.0, 20.0, 100.0] {
            let (clock, ages) = ages_s(ppm, 3_600, jitter_s);
            let most = ages.iter().copied().fold(0.0, f64::max);
            // The jitter, and what is not known of the drift before its estimate.
            assert!(most < 0.03, "{ppm} ppm: {most} s");
            let late = &ages[ages.len() / 2..];
            let most = late.iter().copied().fold(0.0, f64::max);
            assert!(most < 0.007, "{ppm} ppm: {most} s");
            assert!((clock.drift_ppm() - ppm).abs() < 20.0);
            // Of two independent uniform values of 0 to 5 ms: a third of the width.
            assert!((0.000_8..0.002_7).contains(&clock.jitter_s()));
        }
    }

    #[test]
    fn a_queue_is_seen_at_once_and_for_minutes() {
        let (_, ages) = ages_s(30.0, 300, |at_s| {
            jitter_s(at_s) + if at_s > 60.0 { 0.5 } else { 0.0 }
        });
        let after = &ages[61 * 50..];
        assert!(after.iter().all(|age| (0.47..0.52).contains(age)));
    }

    #[test]
    fn a_queue_that_empties_leaves_nothing() {
        // From 60 to 60.5 s on 0.5 s late; from 62 s on it empties in 1 s.
        let (_, ages) = ages_s(0.0, 80, |at_s| {
            if at_s < 60.0 {
                0.0
            } else {
                (0.5 - 0.5 * (at_s - 62.0).max(0.0)).max(0.0)
            }
        });
        assert!(ages[64 * 50..].iter().all(|age| *age < 0.002));
    }

    #[test]
    fn a_clock_that_is_set_is_mapped_again_without_an_age() {
        for set_by_s in [-3_600.0, -0.3, 0.3, 3_600.0] {
            let mut clock = SourceClock::default();
            for n in 0..2_000 {
                let at_s = f64::from(n) * 0.02;
                let set_s = if n < 1_000 { 0.0 } else { set_by_s };
                let arrived = Time::from_nanos((at_s * 1e9) as i64);
                let age = clock.step(arrived, 5_000.0 + at_s + set_s);
                assert!(age < Duration::from_millis(2), "{set_by_s}: {age:?}");
            }
        }
    }

    #[test]
    fn a_time_that_is_no_number_is_left_out() {
        let mut clock = SourceClock::default();
        let at = |ms: i64| Time::from_nanos(ms * 1_000_000);
        clock.step(at(0), 0.0);
        clock.step(at(120), 0.1);
        let before = clock;
        clock.step(at(200), f64::NAN);
        clock.step(at(200), f64::INFINITY);
        assert_eq!(clock, before);
    }
}
