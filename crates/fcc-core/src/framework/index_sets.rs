//! Sets of conditions, of readings and of sensors.

use core::ops::{BitOr, BitOrAssign};

/// Declares a set of up to 64 things by their index, and the name of its sets of one.
macro_rules! index_set {
    ($(#[$doc:meta])* $name:ident, $one:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
        #[repr(transparent)]
        pub struct $name(u64);

        impl $name {
            /// None of them.
            pub const NONE: Self = Self(0);

            /// All of them.
            pub const ALL: Self = Self(u64::MAX);

            /// One alone, by its index 0..=63; a higher one wraps.
            pub const fn $one(index: u32) -> Self {
                Self(1_u64.wrapping_shl(index))
            }

            /// From the bits as stored, the lowest of the first.
            pub const fn from_bits(bits: u64) -> Self {
                Self(bits)
            }

            /// The bits, for storing.
            pub const fn bits(self) -> u64 {
                self.0
            }

            /// Whether it is empty.
            pub const fn is_empty(self) -> bool {
                self.0 == 0
            }

            /// Whether it contains all of `others`.
            pub const fn contains(self, others: Self) -> bool {
                self.0 & others.0 == others.0
            }

            /// Whether it contains any of `others`.
            pub const fn intersects(self, others: Self) -> bool {
                self.0 & others.0 != 0
            }

            /// With `others`, if `holds`.
            #[must_use]
            pub const fn with(self, others: Self, holds: bool) -> Self {
                if holds { Self(self.0 | others.0) } else { self }
            }

            /// Of `others` those that it contains, only if `keeps`.
            #[must_use]
            pub const fn keeping(self, others: Self, keeps: bool) -> Self {
                if keeps { self } else { Self(self.0 & !others.0) }
            }

            /// The indices, lowest first.
            pub fn iter(self) -> impl Iterator<Item = u32> {
                (0..64).filter(move |index| self.contains(Self::$one(*index)))
            }
        }

        impl BitOr for $name {
            type Output = Self;

            fn bitor(self, others: Self) -> Self {
                Self(self.0 | others.0)
            }
        }

        impl BitOrAssign for $name {
            fn bitor_assign(&mut self, others: Self) {
                self.0 |= others.0;
            }
        }
    };
}

index_set! {
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
    Flags, bit
}

index_set! {
    /// A set of readings, by their places among the measurements.
    ///
    /// ```
    /// use fcc_core::framework::ReadingSet;
    ///
    /// const SPEED: ReadingSet = ReadingSet::named(&["depth", "speed"], &["speed"]);
    /// assert_eq!(SPEED, ReadingSet::one(1));
    /// ```
    ReadingSet, one
}

index_set! {
    /// A set of sensors, by their numbers in the loop.
    SensorSet, one
}

impl ReadingSet {
    /// Those readings of the measurements with these names
    /// ([`NAMES`](super::Readings::NAMES)) that are called so.
    ///
    /// # Panics
    /// If one is not among them: an error of the compiler in a constant.
    #[expect(clippy::indexing_slicing, reason = "it is evaluated by the compiler")]
    pub const fn named(names: &[&str], called: &[&str]) -> Self {
        let mut set = Self::NONE;
        let mut n = 0;
        while n < called.len() {
            let mut place = 0;
            while !equal(names[place].as_bytes(), called[n].as_bytes()) {
                place += 1;
                assert!(place < names.len(), "there is no such reading");
            }
            set = set.with(Self::one(place as u32), true);
            n += 1;
        }
        set
    }
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    match (a, b) {
        ([], []) => true,
        ([a, rest_a @ ..], [b, rest_b @ ..]) => *a == *b && equal(rest_a, rest_b),
        _ => false,
    }
}
