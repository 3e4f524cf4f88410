//! Which of several sensors each reading comes from.
//!
//! The sensors of a loop are in an order of preference, and each writes into
//! measurements of its own. Of each reading the first is taken that is fresh;
//! where none is, the youngest, and of those of one age the first. So a sensor
//! that falls silent is replaced before its readings count as lost, and one
//! that speaks again is taken back.

use core::time::Duration;

use super::{Flags, Reading, Time};
use crate::schema;

/// Measurements, as the readings that they are made of.
///
/// [`readings!`](crate::readings) implements it for a struct. One that names no
/// reading is taken from the first sensor as a whole.
pub trait Readings {
    /// What people call each reading, in their order; at most 32.
    const NAMES: &'static [&'static str] = &[];

    /// Takes over each reading of another sensor that is to be taken before the
    /// one that is here. That sensor is less preferred than those that these
    /// came from.
    fn choose(&mut self, _other: &Self, _sensor: u8, _by: &Preference<'_>) {}

    /// Hands each reading's sensor and time to `visit`, in their order.
    fn each_source(&self, _visit: &mut dyn FnMut(u8, Time)) {}
}

/// Implements [`Readings`](crate::framework::Readings) for a struct whose
/// fields are readings, each with the name that people call it by.
///
/// ```
/// use fcc_core::framework::{Reading, Readings};
///
/// struct Boat {
///     depth_m: Reading<f64>,
///     speed_mps: Reading<f64>,
/// }
///
/// fcc_core::readings!(Boat { depth_m: "depth", speed_mps: "speed" });
/// assert_eq!(Boat::NAMES, ["depth", "speed"]);
/// ```
#[macro_export]
macro_rules! readings {
    ($of:ty { $($field:ident: $name:literal),* $(,)? }) => {
        impl $crate::framework::Readings for $of {
            const NAMES: &'static [&'static str] = &[$($name),*];

            fn choose(
                &mut self,
                other: &Self,
                sensor: u8,
                by: &$crate::framework::Preference<'_>,
            ) {
                $(self.$field.choose(&other.$field, sensor, by);)*
            }

            fn each_source(&self, visit: &mut dyn FnMut(u8, $crate::framework::Time)) {
                $(visit(self.$field.source, self.$field.taken);)*
            }
        }
    };
}

/// A value that no sensor gives a time.
impl Readings for u64 {}
impl Readings for f64 {}
impl Readings for () {}

impl<T: Copy> Readings for Reading<T> {
    const NAMES: &'static [&'static str] = &["reading"];

    fn choose(&mut self, other: &Self, sensor: u8, by: &Preference<'_>) {
        if by.is_fresh(self, self.source) {
            return;
        }
        if by.is_fresh(other, sensor) || by.taken(other) > by.taken(self) {
            *self = Self {
                source: sensor,
                ..*other
            };
        }
    }

    fn each_source(&self, visit: &mut dyn FnMut(u8, Time)) {
        visit(self.source, self.taken);
    }
}

/// By what one sensor's reading is taken before another's.
#[derive(Clone, Copy, Debug)]
pub struct Preference<'a> {
    /// The tick's time. A reading of the future is never fresh, and older than
    /// any other.
    pub now: Time,
    /// How old a reading of each sensor may be to be fresh, by the sensors'
    /// places in the loop.
    pub fresh_for: &'a [Duration],
}

impl Preference<'_> {
    fn is_fresh<T>(&self, reading: &Reading<T>, sensor: u8) -> bool {
        let fresh_for = self.fresh_for.get(usize::from(sensor));
        reading.taken <= self.now
            && fresh_for.is_some_and(|fresh_for| reading.is_fresh(self.now, *fresh_for))
    }

    fn taken<T>(&self, reading: &Reading<T>) -> Time {
        if reading.taken <= self.now {
            reading.taken
        } else {
            Time::NEVER
        }
    }
}

/// As many readings as there are [`Flags`].
const MOST: usize = 32;

/// Remembers which sensor each reading came from.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// None before the first reading.
    known: [Option<u8>; MOST],
}

schema! {
    /// Readings that come from another sensor than before.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct SourceChange {
        /// Which: a bit for each, in the order of the measurements.
        #[field(1)]
        pub readings: Flags,
        /// The place of the sensor before.
        #[field(2)]
        pub from: u8,
        /// The place of the sensor now.
        #[field(3)]
        pub to: u8,
    }
}

impl Sources {
    /// Looks at a tick's measurements and hands what has changed to `changed`,
    /// readings that went the same way together. Where a reading first comes
    /// from is no change.
    pub fn watch(&mut self, measurements: &impl Readings, mut changed: impl FnMut(SourceChange)) {
        let before = self.known;
        let mut known = self.known.iter_mut();
        measurements.each_source(&mut |sensor, taken| {
            if let Some(known) = known.next()
                && !taken.is_never()
            {
                *known = Some(sensor);
            }
        });
        if before == self.known {
            return;
        }
        let way = |bit: u32| {
            let at = |of: &[Option<u8>; MOST]| of.get(bit as usize).copied().flatten();
            Some((at(&before)?, at(&self.known)?)).filter(|(from, to)| from != to)
        };
        let mut told = Flags::NONE;
        for first in 0..MOST as u32 {
            let Some((from, to)) = way(first).filter(|_| !told.contains(Flags::bit(first))) else {
                continue;
            };
            let readings = (first..MOST as u32).fold(Flags::NONE, |all, bit| {
                all.with(Flags::bit(bit), way(bit) == Some((from, to)))
            });
            told |= readings;
            changed(SourceChange { readings, from, to });
        }
    }
}
