//! Set points that Python commands, checked.

use std::collections::HashMap;

use fcc_core::framework::LoopCommand;
use fcc_fixed_wing::{Autopilot, AutopilotCommand, AutopilotConfig};
use fcc_flight::flight::setpoint_limits;
use fcc_telemetry::{Command, InvalidCommand};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arguments::{finite, within};

/// Keywords of a command: set points by their names; None stays as it is.
pub(crate) type Given = HashMap<String, Option<f64>>;

/// Commands for the controller, in the order of execution.
pub(crate) fn commands(
    given: Option<Given>,
    config: &AutopilotConfig,
) -> PyResult<Vec<AutopilotCommand>> {
    let given: Vec<_> = given.unwrap_or_default().into_iter().collect();
    let given: Vec<_> = given
        .iter()
        .filter_map(|(name, value)| Some((name.as_str(), (*value)?)))
        .collect();
    for (name, value) in &given {
        finite(name, *value)?;
    }
    let limits = setpoint_limits(config);
    let commands = Command::set(given)
        .for_the_loop::<Autopilot>(&limits)
        .map_err(|refused| match refused {
            InvalidCommand::Outside(outside) => {
                // To a hundredth: a value printed as a limit is accepted.
                let [least, most] =
                    [outside.least, outside.most].map(|limit| (limit * 100.0).round() / 100.0);
                within(&outside.name, outside.value, least, most)
                    .err()
                    .unwrap_or_else(|| PyValueError::new_err(outside.to_string()))
            }
            other => PyValueError::new_err(other.to_string()),
        })?;
    let of_controller = |command| match command {
        LoopCommand::Controller(command) => Some(command),
        _ => None,
    };
    Ok(commands.into_iter().filter_map(of_controller).collect())
}
