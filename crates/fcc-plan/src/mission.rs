//! The three lists that ground stations send by MAVLink: mission, fence, rally points.
//!
//! Items are numbered from 0 there, also in jumps, and home is none of them.

pub use crate::command::Command;

use crate::command::{FenceReader, Refusal, decode, encode, fence_commands, rally_commands};
use crate::item::Item;
use crate::plan::{Fence, Plan, RallyPoint, limits};
use crate::problem::Problem;

/// The items of a mission.
///
/// # Errors
/// The first problem, with the number of the item from 1.
pub fn items(commands: &[Command]) -> Result<Vec<Item>, Problem> {
    if commands.len() > limits::ITEMS {
        let what = format!("{}: give at most {}", commands.len(), limits::ITEMS);
        return Err(Problem::of("items", what));
    }
    let one = |(n, command): (usize, &Command)| {
        let mut command = *command;
        if let (JUMP, [to, ..]) = (command.id, &mut command.parameters) {
            *to += 1.0;
        }
        match decode(n + 1, &command)? {
            Item::Jump { to, .. } if to > commands.len() => {
                let what = format!("{}: there is no such item", to - 1);
                Err(Problem::of_item(n + 1, "parameter 1 (item)", what))
            }
            item => Ok(item),
        }
    };
    commands.iter().enumerate().map(one).collect()
}

const JUMP: u16 = crate::command::id::JUMP;

/// A fence; its floor and ceiling are no commands.
///
/// # Errors
/// The first problem.
pub fn fence(commands: &[Command]) -> Result<Fence, Problem> {
    Ok(read(commands)?.fence)
}

/// Rally points.
///
/// # Errors
/// The first problem.
pub fn rally(commands: &[Command]) -> Result<Vec<RallyPoint>, Problem> {
    Ok(read(commands)?.rally)
}

fn read(commands: &[Command]) -> Result<FenceReader, Problem> {
    let mut reader = FenceReader::default();
    let problem = |n: usize| move |(field, message): Refusal| Problem::of_item(n, field, message);
    for (n, command) in commands.iter().enumerate() {
        reader.take(command).map_err(problem(n + 1))?;
    }
    reader.complete().map_err(problem(commands.len()))?;
    Ok(reader)
}

/// The lists of a plan: mission, fence, rally points.
pub fn lists(plan: &Plan) -> [Vec<Command>; 3] {
    let items = plan.items.iter().map(|item| {
        let mut command = encode(item);
        if let (JUMP, [to, ..]) = (command.id, &mut command.parameters) {
            *to -= 1.0;
        }
        command
    });
    [
        items.collect(),
        fence_commands(&plan.fence).collect(),
        rally_commands(&plan.rally).collect(),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// MAVLink, "Mission Protocol": sequence numbers begin with 0.
    #[test]
    fn jumps_are_numbered_from_0() {
        let waypoint = Command {
            id: 16,
            frame: 3,
            parameters: [0.0, 0.0, 0.0, 0.0, 47.5, 9.0, 100.0],
        };
        let jump = Command {
            id: 177,
            frame: 2,
            parameters: [0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        let read = items(&[waypoint, jump]).unwrap();
        assert_eq!(
            read[1],
            Item::Jump {
                to: 1,
                times: Some(2)
            }
        );
        let plan = Plan {
            items: read,
            ..Plan::default()
        };
        assert_eq!(lists(&plan)[0], [waypoint, jump]);
        let mut beyond = jump;
        beyond.parameters[0] = 2.0;
        assert_eq!(items(&[waypoint, beyond]).unwrap_err().item, Some(2));
    }

    #[test]
    fn a_fence_that_lacks_a_corner_is_refused() {
        let corner = |latitude: f64| Command {
            id: 5_001,
            frame: 0,
            parameters: [3.0, 0.0, 0.0, 0.0, latitude, 9.0, 0.0],
        };
        assert!(fence(&[corner(47.0), corner(47.1)]).is_err());
        let whole = [corner(47.0), corner(47.1), corner(47.2)];
        assert_eq!(fence(&whole).unwrap().polygons[0].corners.len(), 3);
    }
}
