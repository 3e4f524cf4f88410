//! What the loop runs.

use core::fmt;

use super::schema::Schema;
use super::{Flags, Reading, Readings, Tick, Time};
use crate::schema;

schema! {
    /// The position of the switch that engages the loop.
    ///
    /// ```
    /// use fcc_core::framework::Switch;
    ///
    /// assert_eq!(Switch::from_number(1), Some(Switch::On));
    /// ```
    pub enum Switch {
        /// Hands off.
        Off = 0,
        /// The loop shall control.
        On = 1,
    }
}

/// What the loop runs: from measurements to outputs.
///
/// In each tick the loop calls, in this order and each at most once:
/// [`command`](Self::command) for every command, [`estimate`](Self::estimate)
/// (in every state), [`engage`](Self::engage) if it is to begin, then
/// [`guide`](Self::guide) and [`control`](Self::control) while engaged or
/// [`failsafe`](Self::failsafe) while in failsafe. All of them are pure
/// functions of the controller's state and what they are handed: they read no
/// clock, allocate nothing and do not panic.
///
/// ```
/// use fcc_core::framework::{Controller, Flags, Tick};
///
/// /// Heats below 21 °C. The temperature is all that is measured.
/// struct Heating {
///     wanted_c: f64,
/// }
///
/// impl Controller for Heating {
///     type Measurements = f64;
///     type Estimate = ();
///     type Setpoints = f64;
///     type Outputs = bool;
///     type Command = f64;
///
///     fn estimate(&mut self, _: &Tick, _: &f64) {}
///
///     fn engage_inhibits(&self, _: &Tick, measured_c: &f64) -> Flags {
///         Flags::NONE.with(Flags::bit(0), !measured_c.is_finite())
///     }
///
///     fn faults(&self, tick: &Tick, measured_c: &f64) -> Flags {
///         self.engage_inhibits(tick, measured_c)
///     }
///
///     fn flag_name(_: u32) -> &'static str {
///         "the thermometer is broken"
///     }
///
///     fn engage(&mut self, _: &Tick, _: &f64) {}
///
///     fn control(&mut self, _: &Tick, measured_c: &f64) -> bool {
///         *measured_c < self.wanted_c
///     }
///
///     fn failsafe(&mut self, _: &Tick, _: &f64) -> bool {
///         false
///     }
///
///     fn command(&mut self, wanted_c: &f64) {
///         self.wanted_c = *wanted_c;
///     }
///
///     fn setpoints(&self) -> f64 {
///         self.wanted_c
///     }
///
///     fn outputs_are_valid(&self, _: &bool) -> bool {
///         true
///     }
/// }
///
/// let (mut heating, tick) = (Heating { wanted_c: 21.0 }, Tick::default());
/// assert!(heating.control(&tick, &19.0));
/// heating.command(&18.0);
/// assert!(!heating.control(&tick, &19.0));
/// assert!(!heating.faults(&tick, &f64::NAN).is_empty());
/// ```
pub trait Controller: Send {
    /// What the sensors measure.
    type Measurements: Schema + Readings;
    /// What the controller makes of the measurements, for those who watch.
    type Estimate: Schema;
    /// What the controller aims for, for those who watch.
    type Setpoints: Schema;
    /// What the actuators carry out.
    type Outputs: Schema;
    /// What may be asked of the controller from outside.
    type Command: Schema;

    /// Follows the plant, in every state of the loop: filters and estimates,
    /// so that they are settled when the loop engages.
    fn estimate(&mut self, tick: &Tick, measurements: &Self::Measurements);

    /// Why the loop may not engage now; empty if it may.
    fn engage_inhibits(&self, tick: &Tick, measurements: &Self::Measurements) -> Flags;

    /// What makes going on unsafe, while engaged; empty if nothing does.
    fn faults(&self, tick: &Tick, measurements: &Self::Measurements) -> Flags;

    /// The name of one bit of [`engage_inhibits`](Self::engage_inhibits) and
    /// [`faults`](Self::faults), in words for people.
    fn flag_name(bit: u32) -> &'static str
    where
        Self: Sized;

    /// A command to this controller, in words for people.
    ///
    /// # Errors
    /// What the formatter says.
    fn write_command(_command: &Self::Command, f: &mut fmt::Formatter<'_>) -> fmt::Result
    where
        Self: Sized,
    {
        f.write_str("something of the controller")
    }

    /// Takes over: captures the present as set points, so that the outputs do
    /// not jump.
    fn engage(&mut self, tick: &Tick, measurements: &Self::Measurements);

    /// Works out where to go next: set points.
    fn guide(&mut self, _tick: &Tick, _measurements: &Self::Measurements) {}

    /// Works out the outputs that lead there.
    fn control(&mut self, tick: &Tick, measurements: &Self::Measurements) -> Self::Outputs;

    /// The safest outputs that what is left of the measurements allows.
    fn failsafe(&mut self, tick: &Tick, measurements: &Self::Measurements) -> Self::Outputs;

    /// Loads what the next tick will run and read into the caches, without
    /// effect: its outputs are the same to the last bit with and without it.
    /// Called shortly before a tick if there is time; the rules of a tick
    /// apply. Does nothing by default.
    fn warm_up(&self, _tick: &Tick, _measurements: &Self::Measurements) {}

    /// Lets go.
    fn disengage(&mut self) {}

    /// Takes a command from outside; one that makes no sense now is left.
    fn command(&mut self, _command: &Self::Command) {}

    /// What it makes of the measurements at present.
    fn estimated(&self) -> Self::Estimate {
        Self::Estimate::default()
    }

    /// The present set points.
    fn setpoints(&self) -> Self::Setpoints;

    /// Whether these outputs may be sent: every one finite and in its range.
    fn outputs_are_valid(&self, outputs: &Self::Outputs) -> bool;

    /// The engage switch as measured; never read where there is none.
    fn switch(&self, _measurements: &Self::Measurements) -> Reading<Switch> {
        Reading::new(Switch::Off, Time::NEVER)
    }
}
