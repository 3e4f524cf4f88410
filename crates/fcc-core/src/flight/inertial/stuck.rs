//! A raw sensor that repeats its last sample.

use crate::framework::Time;

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
