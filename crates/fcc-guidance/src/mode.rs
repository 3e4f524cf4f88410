//! The modes of guidance and their transition table.

use core::fmt;

use fcc_core::schema;

schema! {
    /// The mode of guidance, by its number in the record.
    ///
    /// The complete transition table: rows are modes, columns inputs, `·` means
    /// no change. The configured mode is the one that
    /// [`GuidanceConfig`](super::GuidanceConfig) names; "any other" is every mode but
    /// None.
    ///
    /// | | `Engage` | `SetPoint` | `Plan` | `Pause` | `GoTo` | `Return` | `GoAround` | `Glide` | `Resume(mode)` | `Disengage` |
    /// |---|---|---|---|---|---|---|---|---|---|---|
    /// | **None** | the configured mode | · | · | · | · | · | · | · | · | None |
    /// | **Takeoff** | the configured mode | Hold | Plan | Loiter | `GoTo` | Return | · | Glide | the mode; a pattern if it is configured | None |
    /// | **Land** | the configured mode | Hold | Plan | Loiter | `GoTo` | Return | `GoAround` | Glide | the mode; a pattern if it is configured | None |
    /// | **any other** | the configured mode | Hold | Plan | Loiter | `GoTo` | Return | · | Glide | the mode; a pattern if it is configured | None |
    ///
    /// A plan changes its mode by itself: from Plan to Takeoff and Land at these items, from
    /// Takeoff to Plan at its altitude, from Land to `GoAround` outside of the limits of a
    /// landing, and from there to Plan again. While the wheels are on the ground nothing
    /// but `Disengage` changes a mode.
    ///
    /// | needs | |
    /// |---|---|
    /// | Plan, Takeoff, Land, `GoAround` | a plan in the configuration, and a position |
    /// | Loiter, `GoTo`, Return | a position |
    ///
    /// A Glide ends on the ground; it is begun without a position, too, with wings level.
    ///
    /// What lacks what it needs changes nothing. A Loiter or `GoTo` that is resumed
    /// circles where the aircraft is: its place is not part of a
    /// [`Progress`](super::Progress).
    ///
    /// ```
    /// use fcc_guidance::{Mode, ModeInput};
    ///
    /// // A heading that is commanded ends a pattern, and the rest is held.
    /// let after = Mode::TimedPattern.after(ModeInput::SetPoint, Mode::TimedPattern);
    /// assert_eq!(after, Some(Mode::Hold));
    /// ```
    pub enum Mode {
        /// No mode: the loop is not engaged.
        None = 0,
        /// [`Hold`](super::Hold).
        Hold = 1,
        /// [`TimedPattern`](super::TimedPattern).
        TimedPattern = 2,
        /// The flight plan, item by item.
        Plan = 3,
        /// A circle, to wait: the plan is paused.
        Loiter = 4,
        /// To a commanded place, and around it.
        GoTo = 5,
        /// Home, or to a nearer place to return to, and around it.
        Return = 6,
        /// On the runway, and away from it to the altitude of the plan's item.
        Takeoff = 7,
        /// On the glide path, and on the runway to a stop.
        Land = 8,
        /// A landing is given up: away from the runway, and to the landing again.
        GoAround = 9,
        /// Without power: to a place that is reached, and down.
        Glide = 10,
    }
}

/// What can change the mode.
///
/// ```
/// use fcc_guidance::{Mode, ModeInput};
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
    /// The plan is to be flown, or continued.
    Plan,
    /// The aircraft is to wait.
    Pause,
    /// A place is commanded.
    GoTo,
    /// The aircraft is to return.
    Return,
    /// A landing is to be given up.
    GoAround,
    /// There is no power.
    Glide,
    /// An interrupted flight is to be continued in this mode.
    Resume(Mode),
    /// The loop disengages.
    Disengage,
}

impl Mode {
    /// Every mode, by its number.
    pub const ALL: [Self; 11] = [
        Self::None,
        Self::Hold,
        Self::TimedPattern,
        Self::Plan,
        Self::Loiter,
        Self::GoTo,
        Self::Return,
        Self::Takeoff,
        Self::Land,
        Self::GoAround,
        Self::Glide,
    ];

    /// The mode after an input, by the transition table; it is entered again
    /// even if it is the same. None if the input changes nothing.
    #[must_use]
    pub fn after(self, input: ModeInput, configured: Self) -> Option<Self> {
        match (self, input) {
            (_, ModeInput::Engage) => Some(configured),
            (_, ModeInput::Disengage) => Some(Self::None),
            (Self::None, _) | (_, ModeInput::Resume(Self::None)) => None,
            (_, ModeInput::SetPoint) => Some(Self::Hold),
            (_, ModeInput::Plan) => Some(Self::Plan),
            (_, ModeInput::Pause) => Some(Self::Loiter),
            (_, ModeInput::GoTo) => Some(Self::GoTo),
            (_, ModeInput::Return) => Some(Self::Return),
            (Self::Land, ModeInput::GoAround) => Some(Self::GoAround),
            (_, ModeInput::GoAround) => None,
            (_, ModeInput::Glide) => Some(Self::Glide),
            (_, ModeInput::Resume(mode)) => {
                let is_pattern = mode == Self::TimedPattern;
                (!is_pattern || mode == configured).then_some(mode)
            }
        }
    }

    /// Its name in a configuration.
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Hold => "hold",
            Self::TimedPattern => "timed-pattern",
            Self::Plan => "plan",
            Self::Loiter => "loiter",
            Self::GoTo => "go-to",
            Self::Return => "return",
            Self::Takeoff => "take-off",
            Self::Land => "land",
            Self::GoAround => "go-around",
            Self::Glide => "glide",
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
        assert_eq!(Mode::from_number(6), Some(Mode::Return));
        assert_eq!(Mode::from_number(9), Some(Mode::GoAround));
        assert_eq!(Mode::from_number(10), Some(Mode::Glide));
        assert_eq!(Mode::from_number(11), None);
    }

    /// The table of [`Mode`]'s documentation, written out again.
    #[test]
    fn transitions_follow_the_documented_table() {
        use Mode::{Glide, GoAround, GoTo, Hold, Land, Loiter};
        use Mode::{None as Nothing, Plan, Return, Takeoff, TimedPattern};
        let inputs = [
            ModeInput::Engage,
            ModeInput::SetPoint,
            ModeInput::Plan,
            ModeInput::Pause,
            ModeInput::GoTo,
            ModeInput::Return,
            ModeInput::GoAround,
            ModeInput::Glide,
            ModeInput::Resume(Nothing),
            ModeInput::Resume(Hold),
            ModeInput::Resume(TimedPattern),
            ModeInput::Resume(Plan),
            ModeInput::Resume(Return),
            ModeInput::Resume(Takeoff),
            ModeInput::Disengage,
        ];
        for configured in [Hold, TimedPattern, Plan] {
            let engaged = [
                Some(configured),
                Some(Hold),
                Some(Plan),
                Some(Loiter),
                Some(GoTo),
                Some(Return),
                None,
                Some(Glide),
                None,
                Some(Hold),
                (configured == TimedPattern).then_some(TimedPattern),
                Some(Plan),
                Some(Return),
                Some(Takeoff),
                Some(Nothing),
            ];
            let mut landing = engaged;
            landing[6] = Some(GoAround);
            let mut standby = [None; 15];
            (standby[0], standby[14]) = (Some(configured), Some(Nothing));
            let rows = Mode::ALL.map(|mode| match mode {
                Nothing => (mode, standby),
                Land => (mode, landing),
                _ => (mode, engaged),
            });
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
