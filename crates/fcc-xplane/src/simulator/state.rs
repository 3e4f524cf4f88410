//! The simulator's state.

use fcc_core::flight::PlantState;

/// The simulator's state.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(u8)]
pub enum SimulatorState {
    /// Nothing has arrived for the configured time.
    #[default]
    Silent = 0,
    /// Its time runs at the rate of ours.
    Running = 1,
    /// Paused by its user.
    Paused = 2,
    /// It sends and is not paused, but its clock has not advanced for 250 ms: a
    /// dialog, or loading.
    Stalled = 3,
    /// Its time runs at less than 90 % of ours over 1 to 2 s, or at less than
    /// 95 % in frames of more than 50 ms; until 95 % and 45 ms are regained.
    /// A single freeze is not counted.
    Slow = 4,
    /// Its clock went back by a second or more and continued there, or gained a
    /// second on ours: a flight was loaded. This lasts for one tick only.
    Jumped = 5,
    /// Its time runs more than 2.2 times as fast as ours over 1 to 2 s, until it
    /// is less than 2.1 times as fast.
    Fast = 6,
    /// It shows a recorded flight.
    Replaying = 7,
    /// In this tick it cleared the overrides by itself: an aircraft was loaded.
    /// This lasts for one tick only.
    Reloaded = 8,
}

impl SimulatorState {
    /// The corresponding state of the framework; `None` for silence, which the
    /// framework detects by the age of the readings.
    pub const fn plant_state(self) -> Option<PlantState> {
        match self {
            Self::Silent => None,
            Self::Running => Some(PlantState::Running),
            Self::Paused => Some(PlantState::Paused),
            Self::Stalled => Some(PlantState::Stalled),
            Self::Slow => Some(PlantState::Slow),
            Self::Jumped => Some(PlantState::Jumped),
            Self::Fast => Some(PlantState::Fast),
            Self::Replaying => Some(PlantState::Replaying),
            Self::Reloaded => Some(PlantState::Reloaded),
        }
    }

    /// The state with this number.
    pub(crate) const fn from_number(number: u8) -> Self {
        match number {
            1 => Self::Running,
            2 => Self::Paused,
            3 => Self::Stalled,
            4 => Self::Slow,
            5 => Self::Jumped,
            6 => Self::Fast,
            7 => Self::Replaying,
            8 => Self::Reloaded,
            _ => Self::Silent,
        }
    }
}
