//! The modes of guidance and the one table of how they change.

use core::fmt;

use crate::schema;

schema! {
    /// What guidance flies, by its number in the record.
    ///
    /// The table of changes, whole: rows are modes, columns inputs, `·` means that
    /// nothing changes. The configured mode is the one that
    /// [`GuidanceConfig`](super::GuidanceConfig) names.
    ///
    /// | | `Engage` | `SetPoint` | `Resume(mode)` | `Disengage` |
    /// |---|---|---|---|---|
    /// | **None** | the configured mode | · | · | None |
    /// | **Hold** | the configured mode | Hold | the mode, if it is Hold or configured | None |
    /// | **`TimedPattern`** | the configured mode | Hold | the mode, if it is Hold or configured | None |
    ///
    /// ```
    /// use fcc_core::flight::guidance::{Mode, ModeInput};
    ///
    /// // A heading that is commanded ends a pattern, and the rest is held.
    /// let after = Mode::TimedPattern.after(ModeInput::SetPoint, Mode::TimedPattern);
    /// assert_eq!(after, Some(Mode::Hold));
    /// ```
    pub enum Mode {
        /// Nothing is flown: the loop is not engaged.
        None = 0,
        /// [`Hold`](super::Hold).
        Hold = 1,
        /// [`TimedPattern`](super::TimedPattern).
        TimedPattern = 2,
    }
}

/// What can change the mode.
///
/// ```
/// use fcc_core::flight::guidance::{Mode, ModeInput};
///
/// let engaged = Mode::None.after(ModeInput::Engage, Mode::TimedPattern);
/// assert_eq!(engaged, Some(Mode::TimedPattern));
/// assert_eq!(Mode::None.after(ModeInput::SetPoint, Mode::TimedPattern), None);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ModeInput {
    /// The loop engages.
    Engage,
    /// An airspeed, heading or altitude is commanded.
    SetPoint,
    /// A flight that was cut off is to be gone on with in this mode.
    Resume(Mode),
    /// The loop lets go.
    Disengage,
}

impl Mode {
    /// Every mode, by its number.
    pub const ALL: [Self; 3] = [Self::None, Self::Hold, Self::TimedPattern];

    /// The mode that an input leads to, entered anew even if it is the same:
    /// the one table of changes. None if the input changes nothing.
    #[must_use]
    pub fn after(self, input: ModeInput, configured: Self) -> Option<Self> {
        match (self, input) {
            (_, ModeInput::Engage) => Some(configured),
            (_, ModeInput::Disengage) => Some(Self::None),
            (Self::None, _) => None,
            (_, ModeInput::SetPoint) => Some(Self::Hold),
            (_, ModeInput::Resume(mode)) => {
                (mode == Self::Hold || mode == configured).then_some(mode)
            }
        }
    }

    /// As a configuration spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hold => "hold",
            Self::TimedPattern => "timed-pattern",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_its_mode() {
        for number in 0..=u8::MAX {
            assert!(Mode::from_number(number).is_none_or(|mode| mode as u8 == number));
        }
        assert_eq!(Mode::from_number(2), Some(Mode::TimedPattern));
        assert_eq!(Mode::from_number(3), None);
    }

    /// The table of [`Mode`]'s documentation, typed again.
    #[test]
    fn the_documented_table_holds() {
        use Mode::{Hold, None as Nothing, TimedPattern};
        let inputs = [
            ModeInput::Engage,
            ModeInput::SetPoint,
            ModeInput::Resume(Nothing),
            ModeInput::Resume(Hold),
            ModeInput::Resume(TimedPattern),
            ModeInput::Disengage,
        ];
        let none = Some(Nothing);
        for configured in [Hold, TimedPattern] {
            let starts = Some(configured);
            let pattern = (configured == TimedPattern).then_some(TimedPattern);
            let hold = Some(Hold);
            let rows = [
                (Nothing, [starts, None, None, None, None, none]),
                (Hold, [starts, hold, None, hold, pattern, none]),
                (TimedPattern, [starts, hold, None, hold, pattern, none]),
            ];
            for (mode, expected) in rows {
                for (input, after) in inputs.into_iter().zip(expected) {
                    assert_eq!(
                        mode.after(input, configured),
                        after,
                        "{mode} on {input:?}, configured {configured}"
                    );
                }
            }
        }
    }
}
