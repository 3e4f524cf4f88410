//! A state as plain numbers, for records.

use core::fmt;

use super::{Cause, Flags, State};

/// A [`State`] as plain numbers of a fixed layout, for records: they go through
/// shared memory and files, where an enum that carries data has no place.
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
#[repr(C)]
pub struct StateCode {
    phase: u8,
    cause: u8,
    flags: Flags,
}

const STANDBY: u8 = 0;
const ENGAGED: u8 = 1;
const FAILSAFE: u8 = 2;
const STOPPED: u8 = 3;

const NO_CAUSE: u8 = 0;
const FAULTS: u8 = 1;
const INVALID_OUTPUT: u8 = 2;
const OVERRUN: u8 = 3;

impl StateCode {
    /// From the numbers as stored; none if no state has these.
    pub fn from_parts(phase: u8, cause: u8, flags: Flags) -> Option<Self> {
        let code = Self {
            phase,
            cause,
            flags,
        };
        (Self::from(code.state()) == code).then_some(code)
    }

    /// 0 standby, 1 engaged, 2 failsafe, 3 stopped.
    pub const fn phase(self) -> u8 {
        self.phase
    }

    /// Why it fell into failsafe: 1 by faults, 2 by an invalid output, 3 by
    /// overruns; 0 in every other state.
    pub const fn cause(self) -> u8 {
        self.cause
    }

    /// The faults that led to failsafe, if they did.
    pub const fn flags(self) -> Flags {
        self.flags
    }

    /// The state.
    pub const fn state(self) -> State {
        match (self.phase, self.cause) {
            (STANDBY, _) => State::Standby,
            (ENGAGED, _) => State::Engaged,
            (FAILSAFE, FAULTS) => State::Failsafe(Cause::Faults(self.flags)),
            (FAILSAFE, OVERRUN) => State::Failsafe(Cause::Overrun),
            (FAILSAFE, _) => State::Failsafe(Cause::InvalidOutput),
            _ => State::Stopped,
        }
    }
}

impl From<State> for StateCode {
    fn from(state: State) -> Self {
        let (phase, cause, flags) = match state {
            State::Standby => (STANDBY, NO_CAUSE, Flags::NONE),
            State::Engaged => (ENGAGED, NO_CAUSE, Flags::NONE),
            State::Failsafe(Cause::Faults(flags)) => (FAILSAFE, FAULTS, flags),
            State::Failsafe(Cause::InvalidOutput) => (FAILSAFE, INVALID_OUTPUT, Flags::NONE),
            State::Failsafe(Cause::Overrun) => (FAILSAFE, OVERRUN, Flags::NONE),
            State::Stopped => (STOPPED, NO_CAUSE, Flags::NONE),
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
    fn every_state_comes_back() {
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
    fn only_the_codes_of_states_are_taken() {
        for phase in 0..=u8::MAX {
            for cause in 0..=u8::MAX {
                let taken = StateCode::from_parts(phase, cause, Flags::NONE).is_some();
                let known = matches!((phase, cause), (0 | 1 | 3, 0) | (2, 1..=3));
                assert_eq!(taken, known, "{phase} {cause}");
            }
        }
        // Flags where there are no faults mean nothing.
        assert_eq!(StateCode::from_parts(1, 0, Flags::bit(0)), None);
    }
}
