//! What a controller needs so that its loop can be recorded and watched.

use std::fmt::Debug;

use fcc_core::framework::schema::{Schema, Unknown};
use fcc_core::framework::{Controller, RecordOf};

use crate::schema::Words;
use crate::units::{self, Shown};

/// A controller whose loop can be recorded and watched. The declarations of its
/// types suffice, except for the size of its record.
///
/// ```
/// use fcc_core::framework::{Controller, RecordOf};
/// use fcc_telemetry::schema::{Words, words};
/// use fcc_telemetry::Telemetry;
/// # use fcc_core::framework::{Flags, Reading, Tick};
/// # struct Valve;
/// # impl Controller for Valve {
/// #     type Measurements = Reading<f64>;
/// #     type Estimate = ();
/// #     type Setpoints = ();
/// #     type Outputs = f64;
/// #     type Command = ();
/// #     fn estimate(&mut self, _: &Tick, _: &Reading<f64>) {}
/// #     fn engage_inhibits(&self, _: &Tick, _: &Reading<f64>) -> Flags { Flags::NONE }
/// #     fn faults(&self, _: &Tick, _: &Reading<f64>) -> Flags { Flags::NONE }
/// #     fn flag_name(_: u32) -> &'static str { "" }
/// #     fn engage(&mut self, _: &Tick, _: &Reading<f64>) {}
/// #     fn control(&mut self, _: &Tick, _: &Reading<f64>) -> f64 { 0.0 }
/// #     fn failsafe(&mut self, _: &Tick, _: &Reading<f64>) -> f64 { 0.0 }
/// #     fn setpoints(&self) {}
/// #     fn outputs_are_valid(&self, _: &f64) -> bool { true }
/// # }
///
/// impl Telemetry for Valve {
///     type Words = Words<RecordOf<Self>, { words::<RecordOf<Self>>() }>;
/// }
/// ```
pub trait Telemetry: Controller + 'static {
    /// The words of its record in shared memory.
    type Words: RecordWords<RecordOf<Self>>;

    /// The units in which people read its values: [`units::SI`] or others.
    const UNITS: &'static [Shown] = units::SI;
}

mod sealed {
    pub trait Sealed {}
    impl<T, const N: usize> Sealed for crate::schema::Words<T, N> {}
}

/// A record as 64-bit words: implemented by [`Words`] only.
pub trait RecordWords<T>: sealed::Sealed + Copy + Debug + Send + 'static {
    /// The words of a record.
    fn of_record(record: &T) -> Self;

    /// The record in these words.
    ///
    /// # Errors
    /// When a value is not one of those declared.
    fn record(&self) -> Result<T, Unknown>;
}

impl<T: Schema, const N: usize> RecordWords<T> for Words<T, N>
where
    Self: Debug,
{
    fn of_record(record: &T) -> Self {
        Self::of(record)
    }

    fn record(&self) -> Result<T, Unknown> {
        self.get()
    }
}
