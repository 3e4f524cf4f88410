//! Reads what is asked of the loop from outside.

use fcc_core::framework::{Controller, EventKind, LoopCommand, Tick};
use rtrb::Consumer;

use crate::telemetry_producer::Events;

/// Commands read in one tick at most: enough for hands and for a ground station,
/// and a bound to what a flood of them can cost.
const ORDERS_PER_TICK: usize = 16;

/// What a tick's commands ask of the loop itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum StateRequest {
    None,
    Engage,
    Disengage,
    Stop,
}

/// Reads this tick's commands and hands the controller its own.
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
    for _ in 0..ORDERS_PER_TICK {
        let Ok(command) = ring.pop() else {
            break;
        };
        // Told before it is carried out: one that panics the controller is
        // the one that must be in the recording.
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
