//! Reads what is asked of the loop from outside.

use fcc_core::framework::{Controller, EventKind, Order, Tick};
use rtrb::Consumer;

use crate::telemetry_producer::Events;

/// Orders read in one tick at most: enough for hands and for a ground station,
/// and a bound to what a flood of them can cost.
const ORDERS_PER_TICK: usize = 16;

/// What a tick's orders ask of the loop itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum LoopCommand {
    None,
    Engage,
    Disengage,
    Stop,
}

/// Reads this tick's orders and hands the controller its own.
///
/// An order to the loop itself ends the reading, and the rest wait for the
/// next tick: "engage, then heading 090" must not become "heading 090, then
/// engage", which would forget the heading.
pub(crate) fn read<C: Controller>(
    ring: &mut Consumer<Order<C::Order>>,
    controller: &mut C,
    tick: &Tick,
    events: &mut Events<C::Order>,
) -> LoopCommand {
    for _ in 0..ORDERS_PER_TICK {
        let Ok(order) = ring.pop() else {
            break;
        };
        // Told before it is carried out: one that panics the controller is
        // the one that must be in the recording.
        events.push(tick, EventKind::Ordered(order));
        match order {
            Order::Controller(order) => controller.command(&order),
            Order::Engage => return LoopCommand::Engage,
            Order::Disengage => return LoopCommand::Disengage,
            Order::Stop => return LoopCommand::Stop,
        }
    }
    LoopCommand::None
}
