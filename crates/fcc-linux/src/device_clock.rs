//! The clock of a device.

use core::time::Duration;

use fcc_core::framework::Time;

/// How fast the line follows: readings of this time are weighed together.
const SETTLES_IN_S: f64 = 0.1;
/// More than this of one reading is a delay of the thread that read it, ns.
const MOST_NS: f64 = 1e6;
/// Further away the device has begun anew, or the thread was suspended.
const LOST: Duration = Duration::from_millis(100);

/// Finds when something was measured that a device has stamped with its own clock.
///
/// The times at which samples are read scatter by the delays of the thread and of
/// the bus; the device's own do not, but its clock is up to some percent fast or
/// slow. A line between both clocks follows what was read: a phase-locked loop of
/// second order, critically damped (F. M. Gardner, *Phaselock Techniques*, 2005,
/// chapter 2), in which a single late reading has little weight.
#[derive(Clone, Debug)]
pub(crate) struct DeviceClock {
    /// Nanoseconds of the loop's clock for one of the device's.
    rate: f64,
    latest: Option<(Duration, Time)>,
}

impl Default for DeviceClock {
    fn default() -> Self {
        Self {
            rate: 1.0,
            latest: None,
        }
    }
}

impl DeviceClock {
    /// The time of what the device has stamped with `stamp`, which by the time of
    /// its reading was measured about at `read`.
    pub(crate) fn time(&mut self, stamp: Duration, read: Time) -> Time {
        let time = self.followed(stamp, read).unwrap_or(read);
        self.latest = Some((stamp, time));
        time
    }

    fn followed(&mut self, stamp: Duration, read: Time) -> Option<Time> {
        let (before, then) = self.latest?;
        let passed_ns = stamp.checked_sub(before)?.as_nanos() as f64;
        let expected = then + Duration::from_nanos((passed_ns * self.rate).max(0.0) as u64);
        let late_ns = (read - expected) as f64;
        if late_ns.abs() > LOST.as_nanos() as f64 || passed_ns <= 0.0 {
            self.rate = 1.0;
            return None;
        }
        let late_ns = late_ns.clamp(-MOST_NS, MOST_NS);
        let gain = (passed_ns * 1e-9 / SETTLES_IN_S).min(0.5);
        self.rate += gain * gain / 4.0 * late_ns / passed_ns;
        let moved_ns = gain * late_ns;
        let moved = Duration::from_nanos(moved_ns.abs() as u64);
        Some(if moved_ns < 0.0 {
            expected - moved
        } else {
            expected + moved
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads a device every 5 ms, whose clock is so much fast. Each reading is up to
    /// 1 ms late, and every 40th 20 ms. The largest error of the times after
    /// `settled_s`, ms, and that of the readings.
    fn largest_errors_ms(fast: f64, settled_s: f64) -> (f64, f64) {
        let mut clock = DeviceClock::default();
        let (mut stamped, mut plain) = (0.0_f64, 0.0_f64);
        // A multiplicative generator: Park and Miller (1988).
        let mut seed = 1_u64;
        for number in 1..4_000_u32 {
            let measured_s = f64::from(number) * 0.005;
            seed = seed * 48_271 % 2_147_483_647;
            let scatter_s = seed as f64 / 2_147_483_647.0 * 0.001 - 0.0005;
            let delay_s = if number % 40 == 0 { 0.020 } else { scatter_s };
            let stamp = Duration::from_secs_f64(measured_s * (1.0 + fast));
            let read = Time::from_nanos(((100.0 + measured_s + delay_s) * 1e9) as i64);
            let found_s = clock.time(stamp, read).as_nanos() as f64 * 1e-9 - 100.0;
            if measured_s > settled_s {
                stamped = stamped.max((found_s - measured_s).abs());
                plain = plain.max(delay_s);
            }
        }
        (stamped * 1e3, plain * 1e3)
    }

    #[test]
    fn times_are_those_of_the_device_whatever_delays_the_readings() {
        for fast in [0.0, 0.01, -0.01] {
            let (stamped, plain) = largest_errors_ms(fast, 1.0);
            assert!(plain > 19.9, "{plain} ms");
            assert!(stamped < 0.4, "{stamped} ms with a clock {fast} fast");
        }
    }

    #[test]
    fn a_device_that_begins_anew_is_followed_anew() {
        let mut clock = DeviceClock::default();
        let at = |ms: i64| Time::from_nanos(ms * 1_000_000);
        let stamp = Duration::from_millis;
        assert_eq!(clock.time(stamp(500), at(10)), at(10));
        assert_eq!(clock.time(stamp(505), at(15)), at(15));
        assert_eq!(clock.time(stamp(3), at(20)), at(20), "reset");
        assert_eq!(clock.time(stamp(8), at(900)), at(900), "suspended");
    }
}
