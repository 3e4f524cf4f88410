//! What a controller needs so that its loop can be recorded and watched.

use fcc_core::framework::Controller;

use crate::units::{self, Shown};

/// A controller whose loop can be recorded and watched: the declarations of its
/// types suffice.
///
/// ```
/// use fcc_telemetry::Telemetry;
/// # use fcc_core::framework::{Controller, Flags, Reading, Tick};
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
/// impl Telemetry for Valve {}
/// ```
pub trait Telemetry: Controller + 'static {
    /// The units in which people read its values: [`units::SI`] or others.
    const UNITS: &'static [Shown] = units::SI;
}
