//! The loop's states and their transition table.

use core::fmt;

use super::Flags;

/// The state of the loop.
///
/// The complete transition table: rows are states, columns inputs, `·` means no
/// change.
///
/// | | Engage | Disengage | `SwitchedOff` | Fault | Recovered | `FailsafeEnded` | `ReleaseNow` | Stop |
/// |---|---|---|---|---|---|---|---|---|
/// | **Standby** | Engaged | · | · | · | · | · | · | Stopped |
/// | **Engaged** | · | Standby | Standby, or Stopped if configured | Failsafe | · | · | Standby | Stopped |
/// | **Failsafe** | Engaged | Standby | Standby, or Stopped if configured | · | Engaged | Standby | Standby | Stopped |
/// | **Stopped** | · | · | · | · | · | · | · | · |
///
/// Leaving Engaged or Failsafe for Standby or Stopped releases the actuators.
/// `Engage` is input only when no engage inhibit is active.
///
/// ```
/// use fcc_core::framework::{AfterRelease, Cause, Input, State};
///
/// let failsafe = State::Engaged.after(Input::Fault(Cause::Overrun), AfterRelease::Standby);
/// assert_eq!(failsafe, State::Failsafe(Cause::Overrun));
/// assert!(failsafe.holds_control());
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum State {
    /// The controls belong to the pilot; sensors are read and filters run.
    #[default]
    Standby,
    /// In control.
    Engaged,
    /// In control with the remaining readings: safe outputs for a limited time,
    /// then release.
    Failsafe(Cause),
    /// The loop has ended.
    Stopped,
}

/// Why the loop entered failsafe.
///
/// ```
/// use fcc_core::framework::{Cause, Flags};
///
/// // The controller's first condition, as its `flag_name` names it.
/// assert_ne!(Cause::Faults(Flags::bit(0)), Cause::InvalidOutput);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Cause {
    /// The controller detected these faults, such as readings that are too old.
    Faults(Flags),
    /// The controller's outputs were not finite or out of range.
    InvalidOutput,
    /// Ticks overran their budget, or were missed, as many in a row as
    /// configured.
    Overrun,
}

/// What can change the loop's state.
///
/// ```
/// use fcc_core::framework::{AfterRelease, Input, State};
///
/// let engaged = State::Standby.after(Input::Engage, AfterRelease::Standby);
/// assert_eq!(engaged, State::Engaged);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Input {
    /// Engage: requested, with no engage inhibit active.
    Engage,
    /// Disengage: requested from outside.
    Disengage,
    /// The engage switch was switched off.
    SwitchedOff,
    /// It is unsafe to stay engaged.
    Fault(Cause),
    /// What led to failsafe is over, for good: what was done before goes on.
    Recovered,
    /// Failsafe has lasted as long as configured.
    FailsafeEnded,
    /// Control must be given back at once, without a failsafe: what it was taken
    /// of is no longer there.
    ReleaseNow,
    /// End the loop: requested, a signal, or a panic.
    Stop,
}

/// What follows when control was released by the engage switch, or at the end of
/// failsafe.
///
/// ```
/// use fcc_core::framework::{AfterRelease, Input, State};
///
/// // As in the thesis: switched off, the loop ends.
/// let off = State::Engaged.after(Input::SwitchedOff, AfterRelease::Stop);
/// assert_eq!(off, State::Stopped);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum AfterRelease {
    /// Back to standby, ready to engage again.
    #[default]
    Standby,
    /// The loop ends, as in the thesis of 2012.
    Stop,
}

impl State {
    /// The state after an input, by the transition table.
    #[must_use]
    pub const fn after(self, input: Input, switch_off: AfterRelease) -> Self {
        match (self, input) {
            (Self::Stopped, _) | (_, Input::Stop) => Self::Stopped,
            (Self::Standby | Self::Failsafe(_), Input::Engage)
            | (Self::Failsafe(_), Input::Recovered) => Self::Engaged,
            (Self::Engaged | Self::Failsafe(_), Input::Disengage | Input::ReleaseNow)
            | (Self::Failsafe(_), Input::FailsafeEnded) => Self::Standby,
            (Self::Engaged | Self::Failsafe(_), Input::SwitchedOff) => match switch_off {
                AfterRelease::Standby => Self::Standby,
                AfterRelease::Stop => Self::Stopped,
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
    const INPUTS: [Input; 8] = [
        Input::Engage,
        Input::Disengage,
        Input::SwitchedOff,
        Input::Fault(Cause::InvalidOutput),
        Input::Recovered,
        Input::FailsafeEnded,
        Input::ReleaseNow,
        Input::Stop,
    ];

    /// The table of [`State`]'s documentation, written out again.
    #[test]
    fn transitions_follow_the_documented_table() {
        use State::{Engaged, Standby, Stopped};
        let rows = [
            (
                Standby,
                [
                    Engaged, Standby, Standby, Standby, Standby, Standby, Standby, Stopped,
                ],
            ),
            (
                Engaged,
                [
                    Engaged, Standby, Standby, FAILSAFE, Engaged, Engaged, Standby, Stopped,
                ],
            ),
            (
                FAILSAFE,
                [
                    Engaged, Standby, Standby, FAILSAFE, Engaged, Standby, Standby, Stopped,
                ],
            ),
            (Stopped, [Stopped; 8]),
        ];
        for (state, expected) in rows {
            for (input, after) in INPUTS.into_iter().zip(expected) {
                assert_eq!(
                    state.after(input, AfterRelease::Standby),
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
                state.after(Input::SwitchedOff, AfterRelease::Stop),
                State::Stopped
            );
        }
        assert_eq!(
            State::Standby.after(Input::SwitchedOff, AfterRelease::Stop),
            State::Standby
        );
    }
}
