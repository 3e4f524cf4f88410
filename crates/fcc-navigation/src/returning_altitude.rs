//! Whether an altitude that was rejected as implausible is that of the aircraft again.

use libm::fabs;

use super::plausibility::{HEIGHT_M, is_possible_altitude};
use super::sample_tracker::is_current;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Reading, Time};

/// It is followed for this time, s, in so many samples at least.
const FOLLOWED_S: f64 = 4.0;
const LEAST_SAMPLES: f64 = 8.0;
/// The standard deviation from a steady climb is less than this, m: a push of half a g for
/// a second makes half of it.
const STEADY_M: f64 = 3.0;
/// The climb is that over the ground to within this, m/s: the receiver's velocity, and air
/// 30 K off the standard (ISO 2533) in a climb of 15 m/s. Without a receiver it is less
/// than that of a thermal, m/s.
const CLIMB_DIFFERS_MPS: f64 = 5.0;
const MOST_CLIMB_MPS: f64 = 10.0;
/// It is where the aircraft can be by now: this far, m, from where it was when it was
/// rejected, and from there by as much as the receiver's altitude has changed. That
/// drifts by this much, m/s; without a receiver the aircraft, at the pitch of level flight
/// with its power at the trim, sinks or climbs by that.
const NEAR_M: f64 = 40.0;
const RECEIVER_DRIFTS_MPS: f64 = 1.0;
const UNMEASURED_MPS: f64 = 5.0;

/// What a satellite receiver measures of the height.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    altitude_m: f64,
    climb_rate_mps: f64,
}

impl Receiver {
    /// What it measures at `now`, if it does.
    pub fn of(measured: &Measurements, now: Time) -> Option<Self> {
        let (position, velocity) = (&measured.position, &measured.velocity);
        (is_current(position, now) && is_current(velocity, now)).then_some(Self {
            altitude_m: position.value.altitude_m,
            climb_rate_mps: -velocity.value.down_mps,
        })
    }
}

/// The sums of a straight line through samples, by the time since the first one.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    first: Reading<f64>,
    last: Reading<f64>,
    samples: f64,
    sum_s: f64,
    sum_m: f64,
    sum_s2: f64,
    sum_sm: f64,
    sum_m2: f64,
    /// Of the climb rate over the ground, and in how many samples it was known.
    ground_mps: f64,
    grounds: f64,
}

impl Line {
    fn beginning(first: &Reading<f64>) -> Self {
        Self {
            first: *first,
            last: *first,
            ..Self::default()
        }
    }

    fn lasts_s(&self) -> f64 {
        self.last.taken.since(self.first.taken).as_secs_f64()
    }

    /// Whether a sample can follow the last one.
    fn goes_on_with(&self, new: &Reading<f64>) -> bool {
        let gap_s = new.taken.since(self.last.taken).as_secs_f64();
        HEIGHT_M.holds_over(new.value - self.last.value, gap_s)
    }

    fn add(&mut self, new: &Reading<f64>, receiver: Option<Receiver>) {
        self.last = *new;
        let (at_s, at_m) = (self.lasts_s(), new.value - self.first.value);
        self.samples += 1.0;
        self.sum_s += at_s;
        self.sum_m += at_m;
        self.sum_s2 += at_s * at_s;
        self.sum_sm += at_s * at_m;
        self.sum_m2 += at_m * at_m;
        if let Some(receiver) = receiver {
            self.ground_mps += receiver.climb_rate_mps;
            self.grounds += 1.0;
        }
    }

    /// Whether an aircraft climbs like this.
    fn is_a_climb(&self) -> bool {
        if self.samples < LEAST_SAMPLES {
            return false;
        }
        let centred = |sum: f64, a: f64, b: f64| sum - a * b / self.samples;
        let time_s2 = centred(self.sum_s2, self.sum_s, self.sum_s);
        let climbed_sm = centred(self.sum_sm, self.sum_s, self.sum_m);
        let spread_m2 = centred(self.sum_m2, self.sum_m, self.sum_m);
        let climb_mps = climbed_sm / time_s2;
        let off_m2 = (spread_m2 - climb_mps * climbed_sm) / self.samples;
        let is_likely = if 2.0 * self.grounds > self.samples {
            fabs(climb_mps - self.ground_mps / self.grounds) < CLIMB_DIFFERS_MPS
        } else {
            fabs(climb_mps) < MOST_CLIMB_MPS
        };
        off_m2 < STEADY_M * STEADY_M && is_likely
    }
}

/// Follows an altitude that was rejected, and does not ask what is estimated without it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReturningAltitude {
    /// The last good one, and the receiver's then, m.
    good: Reading<f64>,
    receiver_m: Option<f64>,
    line: Line,
}

impl ReturningAltitude {
    /// After this altitude others were rejected.
    pub fn after(good: Reading<f64>) -> Self {
        Self {
            good,
            ..Self::default()
        }
    }

    /// Takes the newest sample; whether it is to be believed.
    pub fn step(&mut self, new: &Reading<f64>, receiver: Option<Receiver>) -> bool {
        if self.receiver_m.is_none() {
            self.receiver_m = receiver.map(|receiver| receiver.altitude_m);
        }
        if new.taken <= self.line.last.taken {
            return false;
        }
        if !is_possible_altitude(new.value) {
            self.line = Line::default();
            return false;
        }
        if self.line.samples == 0.0 || !self.line.goes_on_with(new) {
            self.line = Line::beginning(new);
        }
        self.line.add(new, receiver);
        if self.line.lasts_s() < FOLLOWED_S {
            return false;
        }
        let line = core::mem::take(&mut self.line);
        line.is_a_climb() && self.can_be_at(new, receiver)
    }

    /// Whether the aircraft can be there by now.
    fn can_be_at(&self, new: &Reading<f64>, receiver: Option<Receiver>) -> bool {
        let passed_s = new.taken.since(self.good.taken).as_secs_f64();
        let moved_m = new.value - self.good.value;
        let (off_m, error_mps) = match receiver.zip(self.receiver_m) {
            Some((receiver, was_m)) => {
                let by_receiver_m = receiver.altitude_m - was_m;
                (moved_m - by_receiver_m, RECEIVER_DRIFTS_MPS)
            }
            None => (moved_m, UNMEASURED_MPS),
        };
        fabs(off_m) < NEAR_M + error_mps * passed_s
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
        receiver: impl Fn(f64) -> Option<Receiver>,
    ) -> Option<f64> {
        let good = Reading::new(900.0, Time::from_nanos(1));
        let mut returning = ReturningAltitude::after(good);
        (1..HZ * 60).find_map(|sample| {
            let at_s = f64::from(sample) / f64::from(HZ);
            let taken = Time::from_nanos(1 + i64::from(sample) * 1_000_000_000 / i64::from(HZ));
            let new = Reading::new(altitude_m(at_s, sample), taken);
            returning.step(&new, receiver(at_s)).then_some(at_s)
        })
    }

    fn climbing(mps: f64) -> impl Fn(f64) -> Option<Receiver> {
        move |at_s| {
            Some(Receiver {
                altitude_m: 950.0 + mps * at_s,
                climb_rate_mps: mps,
            })
        }
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
