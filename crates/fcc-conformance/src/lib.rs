//! The requirements of the traits [`Sensor`] and [`Actuator`], as tests that
//! every adapter runs. For tests only: no crate depends on this one outside
//! them.
//!
//! [`Sensor`]: fcc_core::framework::Sensor
//! [`Actuator`]: fcc_core::framework::Actuator
//!
//! An adapter's test file describes its device with [`SensorBench`] or
//! [`ActuatorBench`], and [`sensor_conformance!`] or [`actuator_conformance!`]
//! generates one test for each requirement:
//!
//! ```
//! use fcc_conformance::{SensorBench, VanishingSource};
//! use fcc_core::framework::{Reading, Sensor, SensorFault, Tick, Time};
//! # use std::sync::Arc;
//! # use std::sync::atomic::{AtomicI64, Ordering};
//!
//! /// A thermometer that another thread reads; it stores what it read here.
//! # #[derive(Clone, Copy, Debug, Default, PartialEq)]
//! # struct Measured { room_c: Reading<f64> }
//! struct Thermometer(Arc<AtomicI64>);
//! # const NOTHING: i64 = i64::MIN;
//! # impl Sensor<Measured> for Thermometer {
//! #     fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
//! #         match self.0.swap(NOTHING, Ordering::Relaxed) {
//! #             NOTHING => return Err(SensorFault::Silent),
//! #             millis => into.room_c = Reading::new(millis as f64 * 1e-3, tick.woke),
//! #         }
//! #         Ok(())
//! #     }
//! #     fn name(&self) -> &'static str { "thermometer" }
//! # }
//!
//! struct Bench { sensor: Thermometer, source: Option<Arc<AtomicI64>> }
//!
//! impl SensorBench for Bench {
//!     type Measurements = Measured;
//!     fn new() -> Self {
//!         let source = Arc::new(AtomicI64::new(NOTHING));
//!         Self { sensor: Thermometer(Arc::clone(&source)), source: Some(source) }
//!     }
//!     fn sensor(&mut self) -> &mut dyn Sensor<Measured> { &mut self.sensor }
//!     fn provide(&mut self) {
//!         if let Some(source) = &self.source { source.store(21_500, Ordering::Relaxed); }
//!     }
//!     fn taken(measured: &Measured) -> Vec<Time> { vec![measured.room_c.taken] }
//! }
//!
//! /// The device can be unplugged: the promises of that are asked as well.
//! impl VanishingSource for Bench {
//!     fn vanish(&mut self) { self.source = None; }
//!     fn come_back(&mut self) { self.source = Some(Arc::clone(&self.sensor.0)); }
//! }
//!
//! fcc_conformance::sensor_conformance!(thermometer: Bench, vanishes);
//! # fcc_conformance::sensor::an_old_value_stays_old::<Bench>();
//! # fcc_conformance::sensor::silence_is_reported_and_ends::<Bench>();
//! ```
//!
//! Linking this crate makes a counting allocator the program's own, and
//! [`allocator_calls`] counts for any other test. Whether a call waits is not
//! measured in time, which no test could rely on: the kernel counts how often
//! a thread gave up its CPU because it had to wait ([`waits`]).
#![allow(
    clippy::missing_panics_doc,
    reason = "every function here is a test: it panics if the requirement is not met"
)]

pub mod actuator;
mod allocations;
pub mod authority;
mod flight;
mod gpsd;
pub mod sensor;
mod ticks;
mod waiting;

pub use actuator::{ActuatorBench, VanishingPlant};
pub use allocations::{allocator_calls, allocator_calls_so_far};
pub use authority::AuthorityBench;
pub use flight::flight_times;
pub use gpsd::RealGpsd;
pub use sensor::{SensorBench, VanishingSource};
pub use ticks::Ticks;
pub use waiting::waits;

/// Generates a module with one test for each requirement of
/// [`Sensor`](fcc_core::framework::Sensor), for a [`SensorBench`]; with `,
/// vanishes` those for a [`VanishingSource`] as well. Named `list` it is an array
/// of the requirements, each with its name, for another test runner.
#[macro_export]
macro_rules! sensor_conformance {
    (list: $bench:ty $(, $vanishes:ident)?) => {
        $crate::sensor_conformance! { @ list list $bench: $($vanishes)? }
    };
    ($name:ident: $bench:ty) => {
        $crate::sensor_conformance! { @ promises $name $bench: }
    };
    ($name:ident: $bench:ty, vanishes) => {
        $crate::sensor_conformance! { @ promises $name $bench: vanishes }
    };
    (@ $as:ident $name:ident $bench:ty: vanishes) => {
        $crate::sensor_conformance! { @ $as $name $bench:
            nothing_is_measured_before_the_source_is_there
            an_old_value_stays_old
            silence_is_reported_and_ends
            sampling_what_vanished_never_waits_nor_allocates
        }
    };
    (@ $as:ident $name:ident $bench:ty: $($more:ident)*) => {
        $crate::$as! { sensor $name $bench:
            every_reading_comes_and_none_is_of_the_future
            a_source_with_nothing_new_changes_no_value
            a_tick_after_missed_ones_is_sampled_like_any
            sampling_never_waits
            sampling_allocates_nothing
            a_sensor_runs_in_a_thread_it_was_not_made_in
            its_name_stays
            $($more)*
        }
    };
}

/// Generates a module with one test for each requirement of
/// [`Actuator`](fcc_core::framework::Actuator), for an [`ActuatorBench`]; with
/// `, vanishes` those for a [`VanishingPlant`] as well; `list` as for sensors.
#[macro_export]
macro_rules! actuator_conformance {
    (list: $bench:ty $(, $vanishes:ident)?) => {
        $crate::actuator_conformance! { @ list list $bench: $($vanishes)? }
    };
    ($name:ident: $bench:ty) => {
        $crate::actuator_conformance! { @ promises $name $bench: }
    };
    ($name:ident: $bench:ty, vanishes) => {
        $crate::actuator_conformance! { @ promises $name $bench: vanishes }
    };
    (@ $as:ident $name:ident $bench:ty: vanishes) => {
        $crate::actuator_conformance! { @ $as $name $bench:
            a_plant_that_vanished_is_a_fault_until_it_is_back
            a_release_that_a_vanished_plant_missed_is_made_up_for
            driving_what_vanished_never_waits_nor_allocates
        }
    };
    (@ $as:ident $name:ident $bench:ty: $($more:ident)*) => {
        $crate::$as! { actuator $name $bench:
            the_first_apply_takes_control_and_each_is_followed
            release_gives_control_back
            a_second_release_does_nothing
            a_release_before_any_apply_does_nothing
            an_apply_after_a_release_takes_control_again
            a_warm_up_has_no_effect
            applying_and_releasing_never_wait
            applying_and_releasing_allocate_nothing
            an_actuator_runs_in_a_thread_it_was_not_made_in
            its_name_stays
            $($more)*
        }
    };
}

/// Generates a module with one test for each requirement of
/// [`ControlAuthority`](fcc_core::framework::ControlAuthority), for an
/// [`AuthorityBench`].
#[macro_export]
macro_rules! authority_conformance {
    ($name:ident: $bench:ty) => {
        $crate::promises! { authority $name $bench:
            what_is_held_is_known_outside
            without_permission_nothing_is_taken
            a_release_from_outside_is_confirmed
            a_cancelled_release_sends_nothing
            a_plant_of_another_kind_is_refused
            the_unique_name_is_its_own
            what_has_not_changed_is_not_reported_again
        }
    };
}

/// The requirements, each with its name.
#[doc(hidden)]
#[macro_export]
macro_rules! list {
    ($kind:ident list $bench:ty: $($requirement:ident)*) => {
        [$((
            stringify!($requirement),
            $crate::$kind::$requirement::<$bench> as fn(),
        )),*]
    };
}

/// A module with a test for each requirement.
#[doc(hidden)]
#[macro_export]
macro_rules! promises {
    ($kind:ident $name:ident $bench:ty: $($requirement:ident)*) => {
        mod $name {
            #[allow(unused_imports, reason = "for the bench's name")]
            use super::*;
            $(
                #[test]
                fn $requirement() {
                    $crate::$kind::$requirement::<$bench>();
                }
            )*
        }
    };
}
