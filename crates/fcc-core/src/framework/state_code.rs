//! A state as plain numbers, for records.

use core::fmt;

use super::schema::{Field, Schema, Sink, Source, Type, Unknown};
use super::{Cause, Flags, State};
use crate::schema;

schema! {
    /// The phase of the loop's state.
    enum Phase {
        /// The controls belong to the pilot; sensors are read and filters run.
        Standby = 0,
        /// In control.
        Engaged = 1,
        /// In control with the remaining readings, for a limited time.
        Failsafe = 2,
        /// The loop has ended.
        Stopped = 3,
    }
}

schema! {
    /// Why the loop entered failsafe.
    #[name("Cause")]
    enum CauseCode {
        /// Not in failsafe.
        None = 0,
        /// Faults.
        Faults = 1,
        /// An invalid output.
        InvalidOutput = 2,
        /// Too many ticks in a row overran their budget.
        Overrun = 3,
    }
}

schema! {
    /// A [`State`] as plain numbers of a fixed layout, for records: they are
    /// stored in shared memory and files, where an enum with data cannot be
    /// used.
    ///
    /// ```
    /// use fcc_core::framework::{Cause, Flags, State, StateCode};
    ///
    /// let failsafe = State::Failsafe(Cause::Faults(Flags::bit(4)));
    /// let code = StateCode::from(failsafe);
    /// assert_eq!((code.phase(), code.cause(), code.flags()), (2, 1, Flags::bit(4)));
    /// assert_eq!(code.state(), failsafe);
    /// assert_eq!(StateCode::from_parts(9, 0, Flags::NONE), None);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
    #[name("State")]
    #[check(Self::is_state)]
    pub struct StateCode {
        /// The phase of the loop's state.
        #[field(1, column = "state")]
        phase: Phase,
        /// Why it entered failsafe.
        #[field(2, column = "state_cause")]
        cause: CauseCode,
        /// The faults that led to it.
        #[field(3, column = "state_flags")]
        flags: Flags,
    }
}

impl StateCode {
    /// The state with these stored numbers; none if there is no such state.
    pub fn from_parts(phase: u8, cause: u8, flags: Flags) -> Option<Self> {
        let code = Self {
            phase: Phase::from_number(phase)?,
            cause: CauseCode::from_number(cause)?,
            flags,
        };
        code.is_state().then_some(code)
    }

    fn is_state(&self) -> bool {
        Self::from(self.state()) == *self
    }

    /// 0 standby, 1 engaged, 2 failsafe, 3 stopped.
    pub const fn phase(self) -> u8 {
        self.phase as u8
    }

    /// Why it entered failsafe: 1 faults, 2 an invalid output, 3 overruns; 0 in
    /// every other state.
    pub const fn cause(self) -> u8 {
        self.cause as u8
    }

    /// The faults that led to failsafe, if they did.
    pub const fn flags(self) -> Flags {
        self.flags
    }

    /// The state.
    pub const fn state(self) -> State {
        match (self.phase, self.cause) {
            (Phase::Standby, _) => State::Standby,
            (Phase::Engaged, _) => State::Engaged,
            (Phase::Failsafe, CauseCode::Faults) => State::Failsafe(Cause::Faults(self.flags)),
            (Phase::Failsafe, CauseCode::Overrun) => State::Failsafe(Cause::Overrun),
            (Phase::Failsafe, _) => State::Failsafe(Cause::InvalidOutput),
            (Phase::Stopped, _) => State::Stopped,
        }
    }
}

/// A state has the values of its code.
impl Schema for State {
    const TYPE: Type = StateCode::TYPE;
    const FIELDS: &'static [Field] = StateCode::FIELDS;

    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W) {
        StateCode::from(*self).write(field, sink);
    }

    fn read<R: Source>(&mut self, field: &'static Field, source: &mut R) -> Result<(), Unknown> {
        let mut code = StateCode::from(*self);
        code.read(field, source)?;
        *self = code.state();
        Ok(())
    }
}

impl From<State> for StateCode {
    fn from(state: State) -> Self {
        let (phase, cause, flags) = match state {
            State::Standby => (Phase::Standby, CauseCode::None, Flags::NONE),
            State::Engaged => (Phase::Engaged, CauseCode::None, Flags::NONE),
            State::Failsafe(Cause::Faults(flags)) => (Phase::Failsafe, CauseCode::Faults, flags),
            State::Failsafe(Cause::InvalidOutput) => {
                (Phase::Failsafe, CauseCode::InvalidOutput, Flags::NONE)
            }
            State::Failsafe(Cause::Overrun) => (Phase::Failsafe, CauseCode::Overrun, Flags::NONE),
            State::Stopped => (Phase::Stopped, CauseCode::None, Flags::NONE),
        };
        Self {
            phase,
            cause,
            flags,
        }
    }
}

impl From<StateCode> for State {
    fn from(code: StateCode) -> Self {
        code.state()
    }
}

impl PartialEq<State> for StateCode {
    fn eq(&self, state: &State) -> bool {
        self.state() == *state
    }
}

impl fmt::Display for StateCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.state().fmt(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_state_is_restored() {
        for state in [
            State::Standby,
            State::Engaged,
            State::Failsafe(Cause::Faults(Flags::from_bits(0x8000_0001))),
            State::Failsafe(Cause::InvalidOutput),
            State::Failsafe(Cause::Overrun),
            State::Stopped,
        ] {
            let code = StateCode::from(state);
            assert_eq!(code.state(), state);
            let read = StateCode::from_parts(code.phase(), code.cause(), code.flags());
            assert_eq!(read, Some(code));
        }
    }

    #[test]
    fn only_codes_of_states_are_accepted() {
        for phase in 0..=u8::MAX {
            for cause in 0..=u8::MAX {
                let taken = StateCode::from_parts(phase, cause, Flags::NONE).is_some();
                let known = matches!((phase, cause), (0 | 1 | 3, 0) | (2, 1..=3));
                assert_eq!(taken, known, "{phase} {cause}");
            }
        }
        // Flags without faults are ignored.
        assert_eq!(StateCode::from_parts(1, 0, Flags::bit(0)), None);
    }
}
