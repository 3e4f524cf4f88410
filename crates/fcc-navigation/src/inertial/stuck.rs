//! A raw sensor that repeats its last sample, or one axis of it.

use fcc_core::framework::Time;

/// How long samples may be the same to the last bit, s: of a coarse sensor in
/// calm air they are for a moment.
const SAME_FOR_S: f64 = 0.5;

/// What moves changes one axis by more than this: specific force, m/s², rates,
/// rad/s, the magnetic field, µT, and the place, m/s.
pub(super) const MOVED_FORCE: f64 = 1.0;
pub(super) const MOVED_RATE: f64 = 0.05;
pub(super) const MOVED_FIELD: f64 = 3.0;
pub(super) const MOVED_MPS: f64 = 2.0;

/// Notices that the samples of a sensor with three axes stay the same to the last
/// bit while another one shows that it moved: a driver that repeats its last
/// sample. At rest all of them may stay the same.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StuckSensor {
    sample: [f64; 3],
    since: Time,
    /// What others showed then.
    others: [[f64; 3]; 2],
}

impl StuckSensor {
    /// Whether this is the last sample again.
    pub(super) fn is_last(&self, sample: [f64; 3]) -> bool {
        sample == self.sample && !self.since.is_never()
    }

    /// Takes a sample; whether it is only repeated. `others` are the samples of
    /// two other sensors, and `enough` how far each changes in one axis only if
    /// it has moved.
    pub(super) fn step(
        &mut self,
        taken: Time,
        sample: [f64; 3],
        others: [[f64; 3]; 2],
        enough: [f64; 2],
    ) -> bool {
        if sample != self.sample || self.since.is_never() {
            *self = Self {
                sample,
                since: taken,
                others,
            };
            return false;
        }
        let has_moved = others
            .iter()
            .zip(&self.others)
            .zip(enough)
            .any(|((now, then), enough)| {
                now.iter()
                    .zip(then)
                    .any(|(now, then)| libm::fabs(now - then) > enough)
            });
        has_moved && taken.since(self.since).as_secs_f64() >= SAME_FOR_S
    }
}

/// An axis that turns faster than this, rad/s (6 °/s), is not at rest: beyond the bias
/// of any gyroscope that is used here.
const TURNS_RADPS: f64 = 0.1;
/// A rate that is repeated so often, and for so long, s, is not used.
const HELD: (u32, f64) = (4, 0.1);
/// An axis is stuck after so many repeats over so long, s, in which another axis changes
/// or the rate is more than the second one, rad/s (57 °/s).
const STUCK: (u32, f64) = (8, 0.2);
const FAST_RADPS: f64 = 1.0;

/// Notices that one axis of the gyroscopes gives a rate to the last bit again and
/// again: one that is stuck, or at the end of its range.
///
/// No aircraft turns so evenly: at 2000 °/s of range and 16 bits, repeats need an
/// angular acceleration of less than 0.3 °/s² for 0.2 s, and no noise. At rest a coarse
/// sensor may repeat its bias.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct StuckAxis {
    sample: [f64; 3],
    axes: [Repeated; 3],
}

#[derive(Clone, Copy, Debug, Default)]
struct Repeated {
    since: Time,
    /// Samples that repeated it, and of those the ones that no driver has given again.
    all: u32,
    measured: u32,
}

impl Repeated {
    fn lasts(self, taken: Time, count: u32, (least, least_s): (u32, f64)) -> bool {
        count >= least && taken.since(self.since).as_secs_f64() >= least_s
    }
}

impl StuckAxis {
    /// Takes a new sample, rad/s; whether it is held, so that it says nothing, and
    /// whether an axis is stuck.
    pub(super) fn step(&mut self, taken: Time, sample: [f64; 3]) -> (bool, bool) {
        let changed = sample != self.sample;
        for ((axis, rate), before) in self.axes.iter_mut().zip(sample).zip(self.sample) {
            if rate == before && libm::fabs(rate) > TURNS_RADPS {
                axis.all = axis.all.saturating_add(1);
                let is_measured = changed || libm::fabs(rate) > FAST_RADPS;
                axis.measured = axis.measured.saturating_add(u32::from(is_measured));
            } else {
                *axis = Repeated {
                    since: taken,
                    ..Repeated::default()
                };
            }
        }
        self.sample = sample;
        let any = |lasts: fn(&Repeated, Time) -> bool| self.axes.iter().any(|a| lasts(a, taken));
        (
            any(|axis, taken| axis.lasts(taken, axis.all, HELD)),
            any(|axis, taken| axis.lasts(taken, axis.measured, STUCK)),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples at 40 Hz, as many as an axis is stuck after: what is said of the last.
    fn after(sample: impl Fn(u32) -> [f64; 3]) -> (bool, bool) {
        let mut axes = StuckAxis::default();
        let mut said = (false, false);
        for tick in 0..=STUCK.0 {
            let taken = Time::from_nanos(i64::from(tick) * 25_000_000);
            said = axes.step(taken, sample(tick));
        }
        said
    }

    #[test]
    fn an_axis_that_measures_one_rate_is_stuck() {
        let noise = |tick: u32| f64::from(tick % 3) * 0.001;
        assert_eq!(after(|tick| [1.0, noise(tick), 0.0]), (true, true));
        // A driver that gives its last sample again.
        assert_eq!(after(|_| [0.9, 0.02, 0.0]), (true, false));
        // All of them at the end of their range.
        assert_eq!(after(|_| [4.36, 4.36, 4.36]), (true, true));
        // The bias of a coarse sensor at rest, and a turn.
        assert_eq!(after(|tick| [0.05, noise(tick), 0.0]), (false, false));
        let turns = |tick| [1.0 + noise(tick), noise(tick), 0.0];
        assert_eq!(after(turns), (false, false));
    }
}
