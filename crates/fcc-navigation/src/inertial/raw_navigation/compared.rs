//! The sensors of one kind, compared with the one that is used.

use nalgebra::Vector3;

use super::sensor_kind::{Samples, difference};
use fcc_core::blocks::smoothing_factor;
use fcc_core::framework::{SensorSet, Time};

/// So many sensors of a kind are compared with the one that is used.
const OTHERS: usize = 3;
/// What is compared are means over this time, s: vibration and unequal delays are none of
/// them.
const MEAN_S: f64 = 0.5;
/// For so long a majority differs from a sensor before that is wrong, s.
const OUTVOTED_FOR_S: f64 = 1.0;
/// A sensor whose latest sample is older, s, says nothing: receivers give one a second.
const SILENT_S: f64 = 1.5;

/// Sensors agree again below this share of what sound ones differ by at most.
const AGREES_SHARE: f64 = 0.5;

/// A sensor beside the one that is used.
#[derive(Clone, Copy, Debug)]
pub(super) struct Other {
    sensor: u8,
    pub(super) samples: Samples,
    /// Means of the differences, as shares of what sound sensors differ by at most.
    apart: [Vector3<f64>; 2],
    latest: Time,
    /// When it was last tried which of the two is wrong.
    pub(super) tried: Time,
}

impl Other {
    fn is_heard(&self, now: Time) -> bool {
        now.since(self.latest).as_secs_f64() < SILENT_S
    }

    fn disagrees(&self, beyond: f64) -> bool {
        self.apart.iter().any(|apart| apart.norm() > beyond)
    }

    fn agrees_with(&self, other: &Self) -> bool {
        let mut pairs = self.apart.iter().zip(&other.apart);
        pairs.all(|(one, other)| (one - other).norm() < 1.0)
    }
}

/// The sensors of one kind.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Compared {
    used: Samples,
    others: [Option<Other>; OTHERS],
    outvoted_since: Time,
    wrong: SensorSet,
}

impl Compared {
    /// Whether a sensor was found to be wrong.
    pub(super) const fn is_wrong(&self, sensor: u8) -> bool {
        self.wrong.contains(bit(sensor))
    }

    /// Whether any was.
    pub(super) const fn has_wrong(&self) -> bool {
        !self.wrong.is_empty()
    }

    /// Takes the samples that are used; whether they are of another sensor than before.
    pub(super) fn follow(&mut self, used: Samples) -> bool {
        let sensors = |samples: Samples| samples.map(|sample| sample.map(|own| own.sensor));
        let is_other = sensors(used) != sensors(self.used);
        if is_other {
            self.others = [None; OTHERS];
            self.outvoted_since = Time::NEVER;
        }
        self.used = used;
        is_other
    }

    /// Takes what one of the sensors measures.
    pub(super) fn observe(&mut self, sensor: u8, own: Samples) {
        let is_only_used = own
            .iter()
            .zip(&self.used)
            .all(|(own, used)| own.is_none() || used.is_none_or(|used| used.sensor == sensor));
        if is_only_used || self.is_wrong(sensor) {
            return;
        }
        let is_its = |of: &&mut Option<Other>| of.is_none_or(|other| other.sensor == sensor);
        let Some(place) = self.others.iter_mut().find(is_its) else {
            return;
        };
        let other = place.get_or_insert(Other {
            sensor,
            samples: [None; 2],
            apart: [Vector3::zeros(); 2],
            latest: Time::NEVER,
            tried: Time::NEVER,
        });
        let velocity = match self.used {
            [_, Some(used)] => used.velocity(),
            _ => [0.0; 3],
        };
        let parts = other.samples.iter_mut().zip(&mut other.apart);
        for (((last, apart), own), used) in parts.zip(&own).zip(&self.used) {
            let (Some(own), Some(used)) = (own, used) else {
                continue;
            };
            if used.sensor == sensor || last.is_some_and(|last| own.taken <= last.taken) {
                continue;
            }
            let before = last.replace(*own);
            if let Some(now_apart) = difference(own, used, velocity)
                && let Some(before) = before
            {
                other.latest = own.taken;
                let dt_s = own.taken.since(before.taken).as_secs_f64();
                *apart += (now_apart - *apart) * smoothing_factor(dt_s, MEAN_S);
            }
        }
    }

    fn sound(&self, now: Time) -> impl Iterator<Item = &Other> {
        let others = self.others.iter().flatten();
        others.filter(move |other| other.is_heard(now) && !self.is_wrong(other.sensor))
    }

    /// Whether a majority differs from the sensor that is used.
    pub(super) fn is_outvoted(&mut self, now: Time) -> bool {
        let all = 1 + self.sound(now).count();
        let against = || self.sound(now).filter(|other| other.disagrees(1.0));
        let is_outvoted = against().any(|one| {
            let agreeing = against().filter(|other| other.agrees_with(one));
            2 * agreeing.count() > all
        });
        if !is_outvoted {
            self.outvoted_since = Time::NEVER;
        } else if self.outvoted_since.is_never() {
            self.outvoted_since = now;
        }
        let for_s = now.since(self.outvoted_since).as_secs_f64();
        is_outvoted && !self.uses_wrong() && for_s >= OUTVOTED_FOR_S
    }

    /// Of those that disagree with the sensor that is used the one that was not tried for the
    /// longest time, and what is used.
    pub(super) fn next_pair(&mut self, now: Time) -> Option<(Samples, &mut Other)> {
        if self.uses_wrong() {
            return None;
        }
        let wrong = self.wrong;
        let others = self.others.iter_mut().flatten();
        let other = others
            .filter(|other| !wrong.contains(bit(other.sensor)))
            .filter(|other| other.is_heard(now) && other.disagrees(1.0))
            .min_by_key(|other| other.tried)?;
        Some((self.used, other))
    }

    /// Whether a sensor still disagrees with the one that is used.
    pub(super) fn disagrees(&self, now: Time, sensor: u8) -> bool {
        let mut others = self.sound(now);
        others.any(|other| other.sensor == sensor && other.disagrees(AGREES_SHARE))
    }

    /// Where all are, the first is used.
    fn uses_wrong(&self) -> bool {
        let mut used = self.used.iter().flatten();
        used.any(|used| self.is_wrong(used.sensor))
    }

    /// The sensor that is used is wrong, where another disagrees with it; which that is.
    pub(super) fn leave_used(&mut self) -> Option<u8> {
        let mut left = None;
        for (place, used) in self.used.into_iter().enumerate() {
            let apart = |other: &Other| other.apart.get(place).map_or(0.0, Vector3::norm);
            let mut others = self.others.iter().flatten();
            if others.any(|other| apart(other) > AGREES_SHARE) {
                left = left.or(used.map(|used| self.leave(used.sensor)));
            }
        }
        left
    }

    /// A sensor is wrong.
    pub(super) fn leave(&mut self, sensor: u8) -> u8 {
        self.wrong |= bit(sensor);
        sensor
    }
}

/// A loop has fewer sensors than there are bits.
const fn bit(sensor: u8) -> SensorSet {
    SensorSet::one(sensor as u32)
}
