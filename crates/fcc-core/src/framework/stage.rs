//! The stages of a tick, by name.

use core::fmt;

use super::StageTimes;
use crate::schema;

schema! {
    /// A stage of a tick, the whole of it, or the wait before it.
    ///
    /// ```
    /// use fcc_core::framework::Stage;
    ///
    /// assert_eq!(Stage::Control.to_string(), "control");
    /// assert_eq!(Stage::from_number(4), Some(Stage::Control));
    /// ```
    pub enum Stage {
        /// The wait for the deadline: it ended whole periods late.
        Timer = 0,
        /// Sampling the sensors.
        Sensors = 1,
        /// [`Controller::estimate`](super::Controller::estimate).
        Estimate = 2,
        /// [`Controller::guide`](super::Controller::guide).
        Guide = 3,
        /// [`Controller::control`](super::Controller::control), or `failsafe`.
        Control = 4,
        /// Driving the actuators.
        Actuators = 5,
        /// All of the tick, from the wake-up to the last actuator write.
        Tick = 6,
    }
}

impl Stage {
    /// The stages that are timed, in their order; not the whole of them.
    pub const TIMED: [Self; 5] = [
        Self::Sensors,
        Self::Estimate,
        Self::Guide,
        Self::Control,
        Self::Actuators,
    ];
}

impl StageTimes {
    /// How long a stage took, ns; 0 for the timer's, which is not timed here.
    pub const fn of(&self, stage: Stage) -> u64 {
        match stage {
            Stage::Timer => 0,
            Stage::Sensors => self.sensors_ns,
            Stage::Estimate => self.estimate_ns,
            Stage::Guide => self.guide_ns,
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
            Self::Estimate => "estimate",
            Self::Guide => "guide",
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
    fn the_longest_stage_is_not_the_whole() {
        let stages = StageTimes {
            estimate_ns: 5,
            control_ns: 7,
            actuators_ns: 7,
            total_ns: 100,
            ..StageTimes::default()
        };
        assert_eq!(stages.longest(), Stage::Control);
    }
}
