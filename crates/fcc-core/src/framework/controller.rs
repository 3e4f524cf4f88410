//! The controller that a loop runs.

use core::fmt;

use super::schema::Schema;
use super::{Flags, Notice, Reading, ReadingSet, Readings, Tick, Time};
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
        /// The pilot controls.
        Off = 0,
        /// The loop is to control.
        On = 1,
    }
}

/// The controller that a loop runs: from measurements to outputs.
///
/// In each tick the loop calls, in this order and each at most once:
/// [`command`](Self::command) for every command, [`estimate`](Self::estimate)
/// (in every state), [`engage`](Self::engage) if it is to engage, then
/// [`guide`](Self::guide) and [`control`](Self::control) while engaged or
/// [`failsafe`](Self::failsafe) while in failsafe. All of them are pure
/// functions of the controller's state and their arguments: they read no clock,
/// allocate nothing and do not panic.
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
    /// The controller's estimate, for observers.
    type Estimate: Schema;
    /// The controller's set points, for observers.
    type Setpoints: Schema;
    /// What the actuators execute.
    type Outputs: Schema;
    /// The commands to the controller from outside.
    type Command: Schema;

    /// Updates filters and estimates in every state of the loop, so that they
    /// are settled when the loop engages.
    fn estimate(&mut self, tick: &Tick, measurements: &Self::Measurements);

    /// Why the loop may not engage now; empty if it may.
    fn engage_inhibits(&self, tick: &Tick, measurements: &Self::Measurements) -> Flags;

    /// Faults that make it unsafe to stay engaged; empty if there are none.
    fn faults(&self, tick: &Tick, measurements: &Self::Measurements) -> Flags;

    /// Whether a failsafe because of [`faults`](Self::faults) goes on however
    /// long it has lasted: what it holds is sound. By default it ends after its
    /// configured time.
    fn failsafe_goes_on(&self) -> bool {
        false
    }

    /// Whether nobody can take over: a failsafe because of overruns that have ended does not
    /// end in a release, however long it has lasted. By default somebody can.
    fn is_unattended(&self) -> bool {
        false
    }

    /// Whether a failsafe is over as far as [`faults`](Self::faults) tell, and what
    /// was done before is to be continued, by [`recover`](Self::recover). One because
    /// of overruns goes on until these are over, too. By default it is never.
    fn has_recovered(&self) -> bool {
        false
    }

    /// Continues what was done before the failsafe, instead of
    /// [`engage`](Self::engage): the set points are kept, and the outputs do not
    /// jump.
    fn recover(&mut self, _tick: &Tick, _measurements: &Self::Measurements) {}

    /// Why control must be given back in this tick, without a failsafe: the
    /// plant is another, or was set to another state. Empty if there is no
    /// reason; by default there is none.
    fn must_release(&self, _tick: &Tick, _measurements: &Self::Measurements) -> Flags {
        Flags::NONE
    }

    /// Whether a person takes control, and how: control is given back at once,
    /// as by switching off. Empty if nobody does, as by default.
    fn is_taken_over(&self, _tick: &Tick, _measurements: &Self::Measurements) -> Flags {
        Flags::NONE
    }

    /// Begins to bring the plant into a state in which it can be released, before
    /// a release that can wait; false to release it at once, as by default.
    fn prepare_release(&mut self, _tick: &Tick, _measurements: &Self::Measurements) -> bool {
        false
    }

    /// Whether the plant can be released now, after
    /// [`prepare_release`](Self::prepare_release).
    fn is_ready_for_release(&self) -> bool {
        true
    }

    /// Whether control that is ended by the switch or by a command is given back like before a
    /// commanded stop, by [`prepare_release`](Self::prepare_release) and however long that
    /// takes: what falls without control is brought to the ground first. By default it is given
    /// back at once.
    fn releases_on_the_ground(&self) -> bool {
        false
    }

    /// Whether this tick's outputs are not to be sent although the loop holds
    /// control: the plant does not take them at present, and keeps the last.
    /// The state does not change. By default they are sent.
    fn withholds_outputs(&self, _tick: &Tick, _measurements: &Self::Measurements) -> bool {
        false
    }

    /// What the controller noticed up to this tick's [`estimate`](Self::estimate), since
    /// that of the tick before, in its order: each is an event. By default nothing.
    fn notices(&self) -> &[Notice] {
        &[]
    }

    /// A notice of this controller, as text for users.
    ///
    /// # Errors
    /// The formatter's error.
    fn write_notice(_notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result
    where
        Self: Sized,
    {
        f.write_str("a notice of the controller")
    }

    /// Conditions to report while control is held that need not be faults; empty
    /// if there are none. The loop reports each change as an event.
    fn conditions(&self, _tick: &Tick, _measurements: &Self::Measurements) -> Flags {
        Flags::NONE
    }

    /// The name of one bit of [`engage_inhibits`](Self::engage_inhibits),
    /// [`faults`](Self::faults), [`must_release`](Self::must_release) and
    /// [`conditions`](Self::conditions), as text for users.
    fn flag_name(bit: u32) -> &'static str
    where
        Self: Sized;

    /// A command to this controller, as text for users.
    ///
    /// # Errors
    /// The formatter's error.
    fn write_command(_command: &Self::Command, f: &mut fmt::Formatter<'_>) -> fmt::Result
    where
        Self: Sized,
    {
        f.write_str("a command to the controller")
    }

    /// Engages: captures the present state as set points, so that the outputs
    /// do not jump.
    fn engage(&mut self, tick: &Tick, measurements: &Self::Measurements);

    /// Computes the set points.
    fn guide(&mut self, _tick: &Tick, _measurements: &Self::Measurements) {}

    /// Computes the outputs that lead to the set points.
    fn control(&mut self, tick: &Tick, measurements: &Self::Measurements) -> Self::Outputs;

    /// The safest outputs that the remaining measurements allow.
    fn failsafe(&mut self, tick: &Tick, measurements: &Self::Measurements) -> Self::Outputs;

    /// Loads what the next tick will run and read into the caches, without
    /// effect: its outputs are the same to the last bit with and without it.
    /// Called shortly before a tick if there is time; the rules of a tick
    /// apply. Does nothing by default.
    fn warm_up(&self, _tick: &Tick, _measurements: &Self::Measurements) {}

    /// Disengages.
    fn disengage(&mut self) {}

    /// Executes a command from outside; one that is not applicable now is
    /// ignored.
    fn command(&mut self, _command: &Self::Command) {}

    /// The present estimate.
    fn estimated(&self) -> Self::Estimate {
        Self::Estimate::default()
    }

    /// The present set points.
    fn setpoints(&self) -> Self::Setpoints;

    /// The present mode, by a number of the controller's own; each change is an
    /// event.
    fn mode(&self) -> u8 {
        0
    }

    /// The name of a mode, as text for users.
    fn mode_name(_mode: u8) -> &'static str
    where
        Self: Sized,
    {
        "unknown"
    }

    /// Whether these outputs may be sent: all finite and within their ranges.
    fn outputs_are_valid(&self, outputs: &Self::Outputs) -> bool;

    /// Takes what one of several sensors measures, by its number in the loop, before one is
    /// chosen for each reading. A recording has the chosen readings only, so what this
    /// changes may affect nothing but [`plausible`](Self::plausible). Not called with one
    /// sensor.
    fn observe_sensor(&mut self, _sensor: u8, _measurements: &Self::Measurements) {}

    /// The plausible readings of one of several sensors, by its number in the loop.
    /// Another is used only if no sensor has a fresh plausible one. All of them by default.
    fn plausible(&self, _sensor: u8, _measurements: &Self::Measurements) -> ReadingSet {
        ReadingSet::ALL
    }

    /// The readings that belong to the first sensor, by the order of preference, that has
    /// ever delivered them. Another sensor's is never used in its place, however old it
    /// is. None by default.
    fn of_one_sensor(&self) -> ReadingSet {
        ReadingSet::NONE
    }

    /// The engage switch as measured; never taken where there is none.
    fn switch(&self, _measurements: &Self::Measurements) -> Reading<Switch> {
        Reading::new(Switch::Off, Time::NEVER)
    }
}
