//! The quantities that control needs, and sets of them.

use core::ops::{BitAnd, BitOr, BitOrAssign, Not};

use fcc_core::flight::Measurements;
use fcc_core::framework::Time;

/// A quantity that control needs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Quantity {
    /// Roll and pitch.
    Attitude,
    /// The heading.
    Heading,
    /// The rates about the axes.
    BodyRates,
    /// The specific force.
    SpecificForce,
    /// The airspeed.
    Airspeed,
    /// The altitude.
    Altitude,
}

impl Quantity {
    /// How many there are.
    pub const COUNT: usize = Self::ALL.len();

    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Attitude,
        Self::Heading,
        Self::BodyRates,
        Self::SpecificForce,
        Self::Airspeed,
        Self::Altitude,
    ];

    /// When its reading was taken.
    pub const fn taken(self, measured: &Measurements) -> Time {
        match self {
            Self::Attitude => measured.attitude.taken,
            Self::Heading => measured.heading_rad.taken,
            Self::BodyRates => measured.body_rates.taken,
            Self::SpecificForce => measured.specific_force.taken,
            Self::Airspeed => measured.airspeed_mps.taken,
            Self::Altitude => measured.altitude_m.taken,
        }
    }

    /// The set of it alone.
    pub const fn alone(self) -> Quantities {
        Quantities(1 << self as u8)
    }
}

/// A set of quantities.
///
/// ```
/// use fcc_navigation::{Quantities, Quantity};
///
/// let lost = Quantities::of(&[Quantity::Attitude, Quantity::Airspeed]);
/// assert!(lost.contains(Quantity::Airspeed) && !lost.contains(Quantity::Heading));
/// assert!(lost.intersects(Quantity::Attitude | Quantity::Heading));
/// assert!((lost & !lost).is_empty());
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Quantities(u8);

impl Quantities {
    /// None of them.
    pub const NONE: Self = Self(0);

    /// All of them.
    pub const ALL: Self = Self::of(&Quantity::ALL);

    /// The set of these.
    pub const fn of(quantities: &[Quantity]) -> Self {
        match quantities {
            [] => Self::NONE,
            [first, rest @ ..] => Self(Self::of(rest).0 | first.alone().0),
        }
    }

    /// Whether it contains this one.
    pub const fn contains(self, quantity: Quantity) -> bool {
        self.0 & quantity.alone().0 != 0
    }

    /// Whether it contains all of these.
    pub const fn contains_all(self, others: Self) -> bool {
        self.0 & others.0 == others.0
    }

    /// Whether it contains any of these.
    pub const fn intersects(self, others: Self) -> bool {
        self.0 & others.0 != 0
    }

    /// Whether it contains none.
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// With this one, if `holds`.
    #[must_use]
    pub const fn with(self, quantity: Quantity, holds: bool) -> Self {
        if holds {
            Self(self.0 | quantity.alone().0)
        } else {
            self
        }
    }

    /// With this one only if it contains it and `keeps`.
    #[must_use]
    pub const fn keeping(self, quantity: Quantity, keeps: bool) -> Self {
        if keeps {
            self
        } else {
            Self(self.0 & !quantity.alone().0)
        }
    }
}

impl BitOr for Quantity {
    type Output = Quantities;

    fn bitor(self, other: Self) -> Quantities {
        self.alone() | other.alone()
    }
}

impl BitOr for Quantities {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Quantities {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

impl BitAnd for Quantities {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl Not for Quantities {
    type Output = Self;

    fn not(self) -> Self {
        Self(Self::ALL.0 & !self.0)
    }
}
