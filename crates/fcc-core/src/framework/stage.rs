//! The stages of a tick, by name.

use core::fmt;

use super::StageTimes;

/// A stage of a tick, the whole of it, or the wait before it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
#[repr(u8)]
pub enum Stage {
    /// The wait for the deadline: it ended whole periods late.
    Timer = 0,
    /// Sampling the sensors.
    Sensors = 1,
    /// [`Controller::estimate`](super::Controller::estimate).
    Navigation = 2,
    /// [`Controller::guide`](super::Controller::guide).
    Guidance = 3,
    /// [`Controller::control`](super::Controller::control), or `failsafe`.
    Control = 4,
    /// Driving the actuators.
    Actuators = 5,
    /// All of the tick, from the wake-up to the last actuator write.
    Tick = 6,
}

impl Stage {
    /// The stages that are timed, in their order; not the whole of them.
    pub const TIMED: [Self; 5] = [
        Self::Sensors,
        Self::Navigation,
        Self::Guidance,
        Self::Control,
        Self::Actuators,
    ];

    /// From the number as stored; none if no stage has it.
    pub const fn from_number(number: u8) -> Option<Self> {
        Some(match number {
            0 => Self::Timer,
            1 => Self::Sensors,
            2 => Self::Navigation,
            3 => Self::Guidance,
            4 => Self::Control,
            5 => Self::Actuators,
            6 => Self::Tick,
            _ => return None,
        })
    }
}

impl StageTimes {
    /// How long a stage took, ns; 0 for the timer's, which is not timed here.
    pub const fn of(&self, stage: Stage) -> u64 {
        match stage {
            Stage::Timer => 0,
            Stage::Sensors => self.sensors_ns,
            Stage::Navigation => self.navigation_ns,
            Stage::Guidance => self.guidance_ns,
            Stage::Control => self.control_ns,
            Stage::Actuators => self.actuators_ns,
            Stage::Tick => self.total_ns,
        }
    }

    /// The stage that took longest; the first of equals.
    pub fn longest(&self) -> Stage {
        Stage::TIMED
            .into_iter()
            .fold(Stage::Sensors, |most, stage| {
                if self.of(stage) > self.of(most) {
                    stage
                } else {
                    most
                }
            })
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Timer => "timer",
            Self::Sensors => "sensors",
            Self::Navigation => "navigation",
            Self::Guidance => "guidance",
            Self::Control => "control",
            Self::Actuators => "actuators",
            Self::Tick => "tick",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_its_stage() {
        for number in 0..=u8::MAX {
            assert!(Stage::from_number(number).is_none_or(|stage| stage as u8 == number));
        }
        assert_eq!(Stage::from_number(6), Some(Stage::Tick));
        assert_eq!(Stage::from_number(7), None);
    }

    #[test]
    fn the_longest_stage_is_not_the_whole() {
        let stages = StageTimes {
            navigation_ns: 5,
            control_ns: 7,
            actuators_ns: 7,
            total_ns: 100,
            ..StageTimes::default()
        };
        assert_eq!(stages.longest(), Stage::Control);
    }
}
