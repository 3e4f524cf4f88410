//! Selects the sensor from which each reading is taken.
//!
//! The sensors of a loop are in an order of preference, and each writes into
//! its own measurements. For each quantity the first fresh reading is taken that
//! the controller calls plausible; if there is none, the first fresh one; if
//! none is fresh, the youngest, and of equal ones the first. So a sensor that
//! becomes silent is replaced before its readings count as lost, one whose
//! values are impossible is replaced at once, and each is used again when it
//! returns. A reading that belongs to one sensor, as a switch does, is never replaced.

use core::time::Duration;

use super::{Reading, ReadingSet, Time};
use crate::schema;

/// Measurements as a collection of readings.
///
/// [`readings!`](crate::readings) implements it for a struct. A struct without
/// named readings is taken as a whole from the first sensor.
pub trait Readings {
    /// The names of the readings, in their order; at most 32.
    const NAMES: &'static [&'static str] = &[];

    /// Replaces each reading by another sensor's if that one is to be
    /// preferred. The other sensor comes later in the order of preference than
    /// those of the present readings.
    fn choose(&mut self, _other: &Self, _sensor: u8, _by: &Preference<'_>) {}

    /// Passes each reading's sensor and time to `visit`, in their order.
    fn each_source(&self, _visit: &mut dyn FnMut(u8, Time)) {}

    /// Changes the time of each reading, in their order.
    fn each_time(&mut self, _change: &mut dyn FnMut(&mut Time)) {}
}

/// Implements [`Readings`](crate::framework::Readings) for a struct whose
/// fields are readings, each with its name for users.
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
                let mut by = *by;
                $(self.$field.choose(&other.$field, sensor, &by);
                by.reading += 1;)*
            }

            fn each_source(&self, visit: &mut dyn FnMut(u8, $crate::framework::Time)) {
                $(visit(self.$field.source, self.$field.taken);)*
            }

            fn each_time(&mut self, change: &mut dyn FnMut(&mut $crate::framework::Time)) {
                $(change(&mut self.$field.taken);)*
            }
        }
    };
}

/// A value without a time.
impl Readings for u64 {}
impl Readings for f64 {}
impl Readings for () {}

impl<T: Copy> Readings for Reading<T> {
    const NAMES: &'static [&'static str] = &["reading"];

    fn choose(&mut self, other: &Self, sensor: u8, by: &Preference<'_>) {
        let is_preferred = if by.of_one_sensor.contains(ReadingSet::one(by.reading)) {
            self.taken.is_never()
        } else {
            by.rank(other, sensor) > by.rank(self, self.source)
        };
        if is_preferred {
            *self = Self {
                source: sensor,
                ..*other
            };
        }
    }

    fn each_source(&self, visit: &mut dyn FnMut(u8, Time)) {
        visit(self.source, self.taken);
    }

    fn each_time(&mut self, change: &mut dyn FnMut(&mut Time)) {
        change(&mut self.taken);
    }
}

/// The criteria by which one sensor's reading is preferred to another's.
#[derive(Clone, Copy, Debug)]
pub struct Preference<'a> {
    /// The tick's time. A reading from the future is never fresh, and counts as
    /// older than any other.
    pub now: Time,
    /// The sensors, by their index in the loop.
    pub sensors: &'a [Preferred],
    /// The index of the first reading that is chosen, 0 for all measurements.
    pub reading: u32,
    /// The readings that belong to the first sensor that has ever delivered them.
    pub of_one_sensor: ReadingSet,
}

/// The criteria that concern one sensor.
#[derive(Clone, Copy, Debug)]
pub struct Preferred {
    /// The age up to which its readings are fresh.
    pub fresh_for: Duration,
    /// Its plausible readings.
    pub plausible: ReadingSet,
}

impl Preference<'_> {
    /// Whether a reading is fresh and plausible, whether it is fresh, and, if
    /// it is not, when it was taken: the greater is preferred.
    fn rank<T>(&self, reading: &Reading<T>, sensor: u8) -> (bool, bool, Time) {
        if reading.taken > self.now {
            return (false, false, Time::NEVER);
        }
        let sensor = self.sensors.get(usize::from(sensor));
        match sensor.filter(|sensor| reading.is_fresh(self.now, sensor.fresh_for)) {
            None => (false, false, reading.taken),
            Some(sensor) => {
                let plausible = sensor.plausible.contains(ReadingSet::one(self.reading));
                (plausible, true, Time::NEVER)
            }
        }
    }
}

/// The maximum number of readings: that of a [`ReadingSet`] at most.
const MOST: usize = 32;

/// Stores which sensor each reading came from.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// None before the first reading.
    known: [Option<u8>; MOST],
}

schema! {
    /// Readings that come from another sensor than before.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct SourceChange {
        /// The readings: a bit for each, in the order of the measurements.
        #[field(1)]
        pub readings: ReadingSet,
        /// The index of the previous sensor.
        #[field(2)]
        pub from: u8,
        /// The index of the present sensor.
        #[field(3)]
        pub to: u8,
    }
}

impl Sources {
    /// Examines a tick's measurements and passes changes to `changed`, readings
    /// with the same change together. The first source of a reading is not a
    /// change.
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
        let mut reported = ReadingSet::NONE;
        for first in 0..MOST as u32 {
            let Some((from, to)) =
                way(first).filter(|_| !reported.contains(ReadingSet::one(first)))
            else {
                continue;
            };
            let readings = (first..MOST as u32).fold(ReadingSet::NONE, |all, bit| {
                all.with(ReadingSet::one(bit), way(bit) == Some((from, to)))
            });
            reported |= readings;
            changed(SourceChange { readings, from, to });
        }
    }
}
