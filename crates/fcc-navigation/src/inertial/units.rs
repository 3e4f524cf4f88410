//! Several sensors of one kind: one that is used no more is left for good.

use super::FoundBy;
use fcc_core::framework::SensorSet;

/// Which sensors of one kind are not used any more, by their number in the loop. The loop
/// takes the first that is not left; so the order of the configuration says which is the
/// best.
///
/// One that is not used any more for whatever reason stays left: a unit that comes and goes
/// would otherwise bring its own bias each time. Only if all are left the first fresh one
/// is used again. What is left follows from the readings that were used alone.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Units {
    used: Option<u8>,
    left: SensorSet,
    /// Why the one that is used is left.
    why: Option<FoundBy>,
}

impl Units {
    /// Takes the number of the sensor that a reading is of; if it is another one than before,
    /// that one, and why it is not used any more.
    pub(super) fn use_of(&mut self, sensor: u8) -> Option<(u8, FoundBy)> {
        let before = self
            .used
            .replace(sensor)
            .filter(|before| *before != sensor)?;
        self.left |= bit(before);
        Some((before, self.why.take().unwrap_or(FoundBy::Silence)))
    }

    /// Why the sensor that is used is not to be used any more, if there is another; none if it
    /// may be.
    pub(super) fn judge(&mut self, why: Option<FoundBy>) {
        self.why = why;
        if let (Some(sensor), Some(_)) = (self.used, why) {
            self.left |= bit(sensor);
        }
    }

    /// Whether a sensor was left, and another one is used.
    pub(super) const fn left_one(&self) -> bool {
        match self.used {
            Some(used) => !self.left.is_empty() && !self.is_left(used),
            None => false,
        }
    }

    /// Whether a sensor was left.
    pub(super) const fn is_left(&self, sensor: u8) -> bool {
        self.left.contains(bit(sensor))
    }
}

/// A loop has fewer sensors than there are bits.
const fn bit(sensor: u8) -> SensorSet {
    SensorSet::one(sensor as u32)
}
