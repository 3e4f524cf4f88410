//! The loop's states and the one table of how they change.

use core::fmt;

use super::Flags;

/// What the loop is doing.
///
/// The table, whole: rows are states, columns inputs, `·` means nothing
/// changes.
///
/// | | Engage | Disengage | `SwitchedOff` | Fault | `FailsafeOver` | Stop |
/// |---|---|---|---|---|---|---|
/// | **Standby** | Engaged | · | · | · | · | Stopped |
/// | **Engaged** | · | Standby | Standby, or Stopped if configured | Failsafe | · | Stopped |
/// | **Failsafe** | Engaged | Standby | Standby, or Stopped if configured | · | Standby | Stopped |
/// | **Stopped** | · | · | · | · | · | · |
///
/// Leaving Engaged or Failsafe for Standby or Stopped releases the actuators.
/// `Engage` is only put in when nothing blocks it.
///
/// ```
/// use fcc_core::framework::{Cause, Input, State, SwitchOff};
///
/// let failsafe = State::Engaged.after(Input::Fault(Cause::Overrun), SwitchOff::Standby);
/// assert_eq!(failsafe, State::Failsafe(Cause::Overrun));
/// assert!(failsafe.holds_control());
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum State {
    /// Watching; the controls are somebody else's.
    #[default]
    Standby,
    /// In control.
    Engaged,
    /// In control of what is left: safe outputs for a while, then release.
    Failsafe(Cause),
    /// Over.
    Stopped,
}

/// Why the loop fell into failsafe.
///
/// ```
/// use fcc_core::framework::{Cause, Flags};
///
/// // The controller's first condition, as its `flag_name` names it.
/// assert_ne!(Cause::Faults(Flags::bit(0)), Cause::InvalidOutput);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cause {
    /// The controller saw these faults: sensors too old, a plant gone.
    Faults(Flags),
    /// The controller's outputs were not finite or not in range.
    InvalidOutput,
    /// Ticks overran their budget, or were missed, as many in a row as
    /// configured.
    Overrun,
}

/// What can change the loop's state.
///
/// ```
/// use fcc_core::framework::{Input, State, SwitchOff};
///
/// let engaged = State::Standby.after(Input::Engage, SwitchOff::Standby);
/// assert_eq!(engaged, State::Engaged);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// Take over: asked for, and nothing blocks it.
    Engage,
    /// Let go: asked for from outside.
    Disengage,
    /// The engage switch went off.
    SwitchedOff,
    /// Going on is unsafe.
    Fault(Cause),
    /// Failsafe has lasted as long as configured.
    FailsafeOver,
    /// End the loop: asked for, a signal, or a panic.
    Stop,
}

/// What switching off the engage switch means.
///
/// ```
/// use fcc_core::framework::{Input, State, SwitchOff};
///
/// // As in the thesis: switched off, the loop ends.
/// let off = State::Engaged.after(Input::SwitchedOff, SwitchOff::Stop);
/// assert_eq!(off, State::Stopped);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum SwitchOff {
    /// Back to standby, ready to engage again.
    #[default]
    Standby,
    /// The loop ends, as in the thesis of 2012.
    Stop,
}

impl State {
    /// The state after an input: the one transition table.
    #[must_use]
    pub const fn after(self, input: Input, switch_off: SwitchOff) -> Self {
        match (self, input) {
            (Self::Stopped, _) | (_, Input::Stop) => Self::Stopped,
            (Self::Standby | Self::Failsafe(_), Input::Engage) => Self::Engaged,
            (Self::Engaged | Self::Failsafe(_), Input::Disengage)
            | (Self::Failsafe(_), Input::FailsafeOver) => Self::Standby,
            (Self::Engaged | Self::Failsafe(_), Input::SwitchedOff) => match switch_off {
                SwitchOff::Standby => Self::Standby,
                SwitchOff::Stop => Self::Stopped,
            },
            (Self::Engaged, Input::Fault(cause)) => Self::Failsafe(cause),
            (state, _) => state,
        }
    }

    /// Whether the loop holds the actuators in this state.
    pub const fn holds_control(self) -> bool {
        matches!(self, Self::Engaged | Self::Failsafe(_))
    }
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Standby => "standby",
            Self::Engaged => "engaged",
            Self::Failsafe(_) => "failsafe",
            Self::Stopped => "stopped",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAILSAFE: State = State::Failsafe(Cause::InvalidOutput);
    const INPUTS: [Input; 6] = [
        Input::Engage,
        Input::Disengage,
        Input::SwitchedOff,
        Input::Fault(Cause::InvalidOutput),
        Input::FailsafeOver,
        Input::Stop,
    ];

    /// The table of [`State`]'s documentation, typed again.
    #[test]
    fn the_documented_table_holds() {
        use State::{Engaged, Standby, Stopped};
        let rows = [
            (
                Standby,
                [Engaged, Standby, Standby, Standby, Standby, Stopped],
            ),
            (
                Engaged,
                [Engaged, Standby, Standby, FAILSAFE, Engaged, Stopped],
            ),
            (
                FAILSAFE,
                [Engaged, Standby, Standby, FAILSAFE, Standby, Stopped],
            ),
            (Stopped, [Stopped; 6]),
        ];
        for (state, expected) in rows {
            for (input, after) in INPUTS.into_iter().zip(expected) {
                assert_eq!(
                    state.after(input, SwitchOff::Standby),
                    after,
                    "{state:?} on {input:?}"
                );
            }
        }
    }

    #[test]
    fn switching_off_stops_if_configured() {
        for state in [State::Engaged, FAILSAFE] {
            assert_eq!(
                state.after(Input::SwitchedOff, SwitchOff::Stop),
                State::Stopped
            );
        }
        assert_eq!(
            State::Standby.after(Input::SwitchedOff, SwitchOff::Stop),
            State::Standby
        );
    }
}
