//! A set of up to 64 conditions.

use core::ops::{BitOr, BitOrAssign};

/// A set of up to 64 conditions: engage inhibits or faults. A controller names
/// its bits ([`Controller::flag_name`](super::Controller::flag_name)).
///
/// ```
/// use fcc_core::framework::Flags;
///
/// let (open, cold) = (Flags::bit(0), Flags::bit(1));
/// let found = Flags::NONE.with(open, true).with(cold, false);
/// assert!(found.contains(open) && !found.intersects(cold));
/// assert_eq!((found | cold).iter().collect::<Vec<_>>(), [0, 1]);
/// assert!(found.keeping(open, false).is_empty());
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
#[repr(transparent)]
pub struct Flags(u64);

impl Flags {
    /// No condition holds.
    pub const NONE: Self = Self(0);

    /// Every condition holds.
    pub const ALL: Self = Self(u64::MAX);

    /// The set of one condition, by its bit 0..=63; a higher bit wraps.
    pub const fn bit(bit: u32) -> Self {
        Self(1_u64.wrapping_shl(bit))
    }

    /// From the bits as stored.
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }

    /// The bits, for storing.
    pub const fn bits(self) -> u64 {
        self.0
    }

    /// Whether no condition holds.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Whether every condition of `other` holds.
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any condition of `other` holds.
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// These conditions, and `other` if `holds`.
    #[must_use]
    pub const fn with(self, other: Self, holds: bool) -> Self {
        if holds { Self(self.0 | other.0) } else { self }
    }

    /// These conditions, but `other` only if `keeps`.
    #[must_use]
    pub const fn keeping(self, other: Self, keeps: bool) -> Self {
        if keeps { self } else { Self(self.0 & !other.0) }
    }

    /// The bits that are set, lowest first.
    pub fn iter(self) -> impl Iterator<Item = u32> {
        (0..64).filter(move |bit| self.contains(Self::bit(*bit)))
    }
}

impl BitOr for Flags {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Flags {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
