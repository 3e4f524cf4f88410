//! Several sensors of one kind: one that is used no more is left for good.

use crate::framework::Flags;

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
    left: Flags,
}

impl Units {
    /// Takes the number of the sensor that a reading is of; whether it is another one than
    /// before.
    pub(super) fn use_of(&mut self, sensor: u8) -> bool {
        let before = self.used.replace(sensor).filter(|before| *before != sensor);
        if let Some(before) = before {
            self.left |= bit(before);
        }
        before.is_some()
    }

    /// The sensor that is used is not to be used any more, if there is another.
    pub(super) fn leave(&mut self) {
        if let Some(sensor) = self.used {
            self.left |= bit(sensor);
        }
    }

    /// Whether a sensor was left.
    pub(super) const fn is_left(&self, sensor: u8) -> bool {
        self.left.contains(bit(sensor))
    }
}

/// A loop has fewer sensors than there are bits.
const fn bit(sensor: u8) -> Flags {
    Flags::bit(sensor as u32)
}
