//! Whether an altitude that was rejected as implausible is that of the aircraft again.

use libm::fabs;

use super::plausibility::{HEIGHT_M, is_possible_altitude};
use fcc_core::framework::Reading;

/// It is followed for this time, s, in so many samples at least.
const FOLLOWED_S: f64 = 4.0;
const LEAST_SAMPLES: u32 = 8;
/// The climb is that of the receiver to within this, m/s: its noise, and air 30 K off the
/// standard (ISO 2533) in a climb of 15 m/s. Without a receiver it is less than that of a
/// thermal, m/s.
const CLIMB_DIFFERS_MPS: f64 = 5.0;
const MOST_CLIMB_MPS: f64 = 10.0;
/// It is where the aircraft can be by now: this far, m, from where it was when it was
/// rejected, and from there by as much as the receiver's altitude has changed. That
/// drifts by this much, m/s; without a receiver the aircraft, at the pitch of level flight
/// with its power at the trim, sinks or climbs by that.
const NEAR_M: f64 = 40.0;
const RECEIVER_DRIFTS_MPS: f64 = 1.0;
const UNMEASURED_MPS: f64 = 5.0;

/// An altitude, and that of a satellite receiver then, m.
#[derive(Clone, Copy, Debug, Default)]
struct Mark {
    altitude: Reading<f64>,
    receiver_m: Option<f64>,
}

impl Mark {
    /// How much has passed since, s; and the climb until then, m: less that of the receiver if
    /// that is known.
    fn until(&self, new: &Self) -> (f64, f64, bool) {
        let passed_s = new.altitude.taken.since(self.altitude.taken).as_secs_f64();
        let climbed_m = new.altitude.value - self.altitude.value;
        let by_receiver_m = self
            .receiver_m
            .zip(new.receiver_m)
            .map(|(was, is)| is - was);
        let off_m = climbed_m - by_receiver_m.unwrap_or(0.0);
        (passed_s, off_m, by_receiver_m.is_some())
    }
}

/// Follows an altitude that was rejected, and does not ask what is estimated without it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReturningAltitude {
    /// The last good one.
    good: Mark,
    /// The first and the last of those that an aircraft can have flown since, and how many.
    first: Mark,
    last: Reading<f64>,
    samples: u32,
}

impl ReturningAltitude {
    /// After this altitude others were rejected.
    pub fn after(good: Reading<f64>) -> Self {
        let good = Mark {
            altitude: good,
            receiver_m: None,
        };
        Self {
            good,
            ..Self::default()
        }
    }

    /// Takes the newest sample, and the altitude of a satellite receiver, m; whether the sample
    /// is to be believed.
    pub fn step(&mut self, altitude: &Reading<f64>, receiver_m: Option<f64>) -> bool {
        self.good.receiver_m = self.good.receiver_m.or(receiver_m);
        if altitude.taken <= self.last.taken {
            return false;
        }
        let gap_s = altitude.taken.since(self.last.taken).as_secs_f64();
        let goes_on = HEIGHT_M.holds_over(altitude.value - self.last.value, gap_s);
        self.last = *altitude;
        if !is_possible_altitude(altitude.value) {
            self.samples = 0;
            return false;
        }
        let new = Mark {
            altitude: *altitude,
            receiver_m,
        };
        if self.samples == 0 || !goes_on {
            (self.first, self.samples) = (new, 0);
        }
        self.samples += 1;
        let (followed_s, climbed_m, is_by_receiver) = self.first.until(&new);
        if followed_s < FOLLOWED_S {
            return false;
        }
        let is_enough = core::mem::take(&mut self.samples) >= LEAST_SAMPLES;
        let most_mps = if is_by_receiver {
            CLIMB_DIFFERS_MPS
        } else {
            MOST_CLIMB_MPS
        };
        let (passed_s, off_m, is_measured) = self.good.until(&new);
        let error_mps = if is_measured {
            RECEIVER_DRIFTS_MPS
        } else {
            UNMEASURED_MPS
        };
        is_enough
            && fabs(climbed_m) < most_mps * followed_s
            && fabs(off_m) < NEAR_M + error_mps * passed_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::framework::Time;

    const HZ: u32 = 25;

    /// When an altitude of the time, s, is believed, that was 900 m before.
    fn returns_after_s(
        altitude_m: impl Fn(f64, u32) -> f64,
        receiver_m: impl Fn(f64) -> Option<f64>,
    ) -> Option<f64> {
        let good = Reading::new(900.0, Time::from_nanos(1));
        let mut returning = ReturningAltitude::after(good);
        (1..HZ * 60).find_map(|sample| {
            let at_s = f64::from(sample) / f64::from(HZ);
            let taken = Time::from_nanos(1 + i64::from(sample) * 1_000_000_000 / i64::from(HZ));
            let new = Reading::new(altitude_m(at_s, sample), taken);
            returning.step(&new, receiver_m(at_s)).then_some(at_s)
        })
    }

    fn climbing(mps: f64) -> impl Fn(f64) -> Option<f64> {
        move |at_s| Some(950.0 + mps * at_s)
    }

    /// 25 m up and down is no aircraft; what comes after it is.
    #[test]
    fn what_was_noisy_is_believed_within_seconds_of_its_end() {
        let noise_m = |sample: u32| 25.0 * f64::from(sample * 7 % 5) - 50.0;
        let noisy = |_, sample| 900.0 + noise_m(sample);
        assert_eq!(returns_after_s(noisy, |_| None), None);
        assert_eq!(returns_after_s(noisy, climbing(0.0)), None);
        let until = |at_s: f64, sample| {
            900.0 - 2.0 * at_s + if at_s < 15.0 { noise_m(sample) } else { 0.0 }
        };
        for at_s in [
            returns_after_s(until, |_| None),
            returns_after_s(until, climbing(-2.0)),
        ] {
            assert!(
                at_s.is_some_and(|at_s| (15.0..24.0).contains(&at_s)),
                "{at_s:?}"
            );
        }
    }

    /// It sinks by 10 m/s and the receiver says that it does not.
    #[test]
    fn a_climb_that_a_receiver_contradicts_is_not_believed() {
        let sinks = |at_s: f64, _| 900.0 - 10.0 * at_s;
        assert_eq!(returns_after_s(sinks, climbing(0.0)), None);
        assert!(returns_after_s(sinks, climbing(-10.0)).is_some());
    }

    /// 300 m in a moment is no flight, however steady it is then.
    #[test]
    fn a_step_is_not_believed_while_the_aircraft_cannot_have_flown_it() {
        let stepped = |_, _| 1_200.0;
        assert_eq!(returns_after_s(stepped, climbing(0.0)), None);
        let at_s = returns_after_s(stepped, |_| None);
        assert!(at_s.is_some_and(|at_s| at_s > 50.0), "{at_s:?}");
    }

    #[test]
    fn what_is_no_number_is_not_believed() {
        assert_eq!(returns_after_s(|_, _| f64::NAN, |_| None), None);
    }
}
