//! What may be asked of a loop from outside.

use fcc_core::framework::Controller;
use rtrb::Consumer;

/// What may be asked of a loop from outside. Orders are carried out in the
/// sequence they were sent in.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Order<O> {
    /// Take over, if nothing blocks it: one attempt, answered by a change of
    /// state or by [`EngageRefused`](crate::EventKind::EngageRefused).
    Engage,
    /// Let go.
    Disengage,
    /// Let go and end the loop.
    Stop,
    /// For the controller.
    Controller(O),
}

/// Orders read in one tick at most: enough for hands and for a ground station,
/// and a bound to what a flood of them can cost.
const ORDERS_PER_TICK: usize = 16;

/// What a tick's orders ask of the loop itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Asked {
    Nothing,
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
) -> Asked {
    for _ in 0..ORDERS_PER_TICK {
        match ring.pop() {
            Ok(Order::Controller(order)) => controller.command(&order),
            Ok(Order::Engage) => return Asked::Engage,
            Ok(Order::Disengage) => return Asked::Disengage,
            Ok(Order::Stop) => return Asked::Stop,
            Err(rtrb::PopError::Empty) => break,
        }
    }
    Asked::Nothing
}
