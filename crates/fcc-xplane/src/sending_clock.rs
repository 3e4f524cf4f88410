//! How late what X-Plane sends arrives, by X-Plane's own clock.
//!
//! The flight's time stands still in a pause, and when X-Plane stops for a moment:
//! a network that begins to hold datagrams looks the same. What tells them apart is
//! a clock that runs on meanwhile, X-Plane's network time. Its list of datarefs
//! calls it the elapsed time synchronised across the network and does not say that
//! it runs on, so it is used only once it has been seen to, and no longer when it
//! stands still.

use core::time::Duration;

use fcc_core::framework::{SourceClock, Time};

/// The network time ran on if it gained so much more than the flight's time, s:
/// more than a frame, and than the rounding of an f32 after a day.
const RUNS_ON_S: f64 = 0.08;
/// It cannot gain more than passed here, but by the network's jitter, s: more is a
/// clock that was set.
const JITTER_S: f64 = 0.05;
/// It stands still if it has not advanced for so long.
const STANDS_STILL: Duration = Duration::from_millis(250);

/// Both times of a datagram, and when it arrived.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    network_s: f64,
    flight_s: f64,
    arrived: Time,
}

/// Maps X-Plane's network time to the loop's.
#[derive(Clone, Debug, Default)]
pub(crate) struct SendingClock {
    map: SourceClock,
    runs_on: bool,
    /// The datagram in which the flight's time last advanced, and the last network
    /// time with the datagram in which that advanced.
    flight_advanced: Times,
    network_s: f64,
    network_advanced: Time,
    stamp: Time,
}

impl SendingClock {
    /// Reads the times of a datagram that has both; datagrams come in order.
    pub(crate) fn receive(&mut self, arrived: Time, network_s: f64, flight_s: f64) {
        let now = Times {
            network_s,
            flight_s,
            arrived,
        };
        let was = self.flight_advanced;
        if was.arrived.is_never() || network_s < self.network_s || flight_s < was.flight_s {
            *self = Self {
                stamp: self.stamp,
                flight_advanced: now,
                network_advanced: arrived,
                network_s,
                ..Self::default()
            };
        } else {
            if network_s > self.network_s {
                self.network_advanced = arrived;
            }
            if arrived.since(self.network_advanced) > STANDS_STILL {
                self.runs_on = false;
            }
            let gained_s = network_s - was.network_s;
            let passed_s = arrived.since(was.arrived).as_secs_f64();
            if !self.runs_on
                && gained_s - (flight_s - was.flight_s) > RUNS_ON_S
                && gained_s < passed_s + JITTER_S
            {
                self.runs_on = true;
                self.map = SourceClock::default();
            }
            if flight_s > was.flight_s {
                self.flight_advanced = now;
            }
            self.network_s = network_s;
        }
        self.map.step(arrived, network_s);
    }

    /// The clock is another one from now on.
    pub(crate) fn map_anew(&mut self) {
        *self = Self {
            stamp: self.stamp,
            ..Self::default()
        };
    }

    /// The age of what arrived last, relative to the fastest datagram; zero while
    /// it is not known.
    fn age(&self) -> Duration {
        if self.runs_on {
            self.map.age()
        } else {
            Duration::ZERO
        }
    }

    /// The time at which was sent what arrives now, as old as what arrived last.
    pub(crate) fn there(&self, now: Time) -> Time {
        let age_ns = i64::try_from(self.age().as_nanos()).unwrap_or(i64::MAX);
        Time::from_nanos(now.as_nanos().saturating_sub(age_ns))
    }

    /// The same for what did arrive now: not before what arrived earlier.
    pub(crate) fn stamp(&mut self, now: Time) -> Time {
        self.stamp = self.there(now).max(self.stamp).min(now);
        self.stamp
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// X-Plane at 50 frames a second, and what it sends.
    struct Bench {
        clock: SendingClock,
        now_s: f64,
        network_s: f64,
        flight_s: f64,
    }

    impl Bench {
        fn new() -> Self {
            Self {
                clock: SendingClock::default(),
                now_s: 1_000.0,
                network_s: 5_000.0,
                flight_s: 60.0,
            }
        }

        /// Frames in which the clocks run at these paces, each arriving `late_s`
        /// late.
        fn run(&mut self, frames: u32, network: f64, flight: f64, late_s: f64) -> Duration {
            for _ in 0..frames {
                self.now_s += 0.02;
                self.network_s += 0.02 * network;
                self.flight_s += 0.02 * flight;
                let arrived = Time::from_nanos(((self.now_s + late_s) * 1e9) as i64);
                let network_s = f64::from(self.network_s as f32);
                self.clock.receive(arrived, network_s, self.flight_s);
            }
            self.clock.age()
        }

        /// It stops for a moment.
        fn freeze(&mut self, seconds: f64, network: f64) {
            self.now_s += seconds;
            self.network_s += seconds * network;
        }
    }

    fn assert_about(age: Duration, expected_s: f64) {
        assert!((age.as_secs_f64() - expected_s).abs() < 0.002, "{age:?}");
    }

    #[test]
    fn a_queue_is_known_once_the_clock_has_run_on_through_a_freeze_or_a_pause() {
        for is_pause in [true, false] {
            let mut bench = Bench::new();
            bench.run(100, 1.0, 1.0, 0.0);
            // Before that it may as well be a freeze.
            assert_eq!(bench.run(100, 1.0, 1.0, 0.5), Duration::ZERO);
            bench.run(100, 1.0, 1.0, 0.0);
            if is_pause {
                bench.run(100, 1.0, 0.0, 0.0);
            } else {
                bench.freeze(0.4, 1.0);
            }
            assert_about(bench.run(100, 1.0, 1.0, 0.0), 0.0);
            assert_about(bench.run(100, 1.0, 1.0, 0.5), 0.5);
            assert_about(bench.run(100, 1.0, 1.0, 0.0), 0.0);
            bench.freeze(3.0, 1.0);
            assert_about(bench.run(1, 1.0, 1.0, 0.0), 0.0);
        }
    }

    #[test]
    fn a_clock_that_stands_still_with_the_flight_is_not_used() {
        let mut bench = Bench::new();
        bench.run(100, 1.0, 1.0, 0.0);
        for _ in 0..10 {
            bench.freeze(0.5, 0.0);
            assert_eq!(bench.run(100, 1.0, 1.0, 0.0), Duration::ZERO);
            assert_eq!(bench.run(100, 0.0, 0.0, 0.0), Duration::ZERO);
        }
        // One that did run on, and then stands still.
        bench.freeze(0.5, 1.0);
        bench.run(50, 1.0, 1.0, 0.0);
        bench.run(100, 0.0, 1.0, 0.0);
        assert_eq!(bench.run(100, 1.0, 1.0, 0.0), Duration::ZERO);
    }

    #[test]
    fn another_flight_or_another_start_is_mapped_anew() {
        for (network_s, flight_s) in [(-4_900.0, 0.0), (0.0, -50.0), (300.0, 0.0)] {
            let mut bench = Bench::new();
            bench.freeze(0.5, 1.0);
            bench.run(100, 1.0, 1.0, 0.0);
            bench.network_s += network_s;
            bench.flight_s += flight_s;
            for _ in 0..200 {
                assert_about(bench.run(1, 1.0, 1.0, 0.0), 0.0);
            }
        }
    }

    /// It may show as little later as if what it sends were held back.
    #[test]
    fn another_simulator_is_mapped_anew() {
        let mut bench = Bench::new();
        bench.run(10, 1.0, 1.0, 0.0);
        bench.freeze(0.5, 1.0);
        bench.run(100, 1.0, 1.0, 0.0);
        bench.now_s += 5.0;
        bench.clock.map_anew();
        assert_about(bench.run(100, 1.0, 1.0, 0.0), 0.0);
    }

    #[test]
    fn what_is_stamped_never_goes_back() {
        let mut bench = Bench::new();
        bench.run(10, 1.0, 1.0, 0.0);
        bench.freeze(0.5, 1.0);
        let mut last = Time::NEVER;
        for late_s in [0.0, 0.1, 0.02, 0.5, 0.5, 0.3, 0.0] {
            bench.run(5, 1.0, 1.0, late_s);
            let now = Time::from_nanos(((bench.now_s + late_s) * 1e9) as i64);
            let sent = bench.clock.stamp(now);
            assert!(sent >= last && sent <= now);
            last = sent;
        }
    }
}
