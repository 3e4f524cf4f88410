//! Reads the commands to the loop.

use fcc_core::framework::{Controller, EventKind, LoopCommand, Tick};
use rtrb::Consumer;

use crate::telemetry_producer::Events;

/// Most commands read in one tick: enough for a pilot and a ground station, and a
/// limit to their cost.
const COMMANDS_PER_TICK: usize = 16;

/// A command to the loop itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum StateRequest {
    None,
    Engage,
    Disengage,
    Stop,
}

/// Reads this tick's commands and passes the controller its own.
///
/// A command to the loop itself ends the reading, and the rest wait for the
/// next tick: "engage, then heading 090" must not become "heading 090, then
/// engage", which would forget the heading.
pub(crate) fn read<C: Controller>(
    ring: &mut Consumer<LoopCommand<C::Command>>,
    controller: &mut C,
    tick: &Tick,
    events: &mut Events<C::Command>,
) -> StateRequest {
    for _ in 0..COMMANDS_PER_TICK {
        let Ok(command) = ring.pop() else {
            break;
        };
        // Reported before it is carried out, so that a command at which the
        // controller panics is in the recording.
        events.push(tick, EventKind::CommandReceived(command));
        match command {
            LoopCommand::Controller(command) => controller.command(&command),
            LoopCommand::Engage => return StateRequest::Engage,
            LoopCommand::Disengage => return StateRequest::Disengage,
            LoopCommand::Stop => return StateRequest::Stop,
        }
    }
    StateRequest::None
}
