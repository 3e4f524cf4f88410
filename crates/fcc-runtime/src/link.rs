//! The other end of a loop's two rings, and its stop flag.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::framework::{Controller, MessageOf, Order};
use rtrb::{Consumer, Producer};

use crate::heartbeat::Heartbeat;

/// How the world outside speaks with a loop.
pub struct Link<C: Controller> {
    /// Orders in.
    pub orders: OrderSender<C::Order>,
    /// Records and events out.
    pub messages: MessageReceiver<C>,
    /// The stop flag.
    pub stop: StopHandle,
    /// Whether it makes progress.
    pub heartbeat: Heartbeat,
}

/// Sends orders to a loop; never waits.
pub struct OrderSender<O> {
    ring: Producer<Order<O>>,
}

impl<O> OrderSender<O> {
    pub(crate) const fn new(ring: Producer<Order<O>>) -> Self {
        Self { ring }
    }

    /// How many orders can be sent now, 0 if the loop is over: for those that
    /// mean something only together.
    pub fn room(&self) -> usize {
        if self.ring.is_abandoned() {
            0
        } else {
            self.ring.slots()
        }
    }

    /// Sends an order; it is read in one of the next ticks.
    ///
    /// # Errors
    /// The order itself, if the loop has not read the ones before, or is over.
    pub fn send(&mut self, order: Order<O>) -> Result<(), OrdersFull<O>> {
        if self.ring.is_abandoned() {
            return Err(OrdersFull(order));
        }
        self.ring
            .push(order)
            .map_err(|rtrb::PushError::Full(order)| OrdersFull(order))
    }
}

/// An order that could not be sent: the ring is full, or the loop is over.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error("the loop takes no more orders now: it is over, or many wait; send again in the next tick")]
pub struct OrdersFull<O>(pub Order<O>);

/// Fetches what a loop tells of itself; never waits.
pub struct MessageReceiver<C: Controller> {
    ring: Consumer<MessageOf<C>>,
}

impl<C: Controller> MessageReceiver<C> {
    pub(crate) const fn new(ring: Consumer<MessageOf<C>>) -> Self {
        Self { ring }
    }

    /// The next message, if there is one.
    pub fn receive(&mut self) -> Option<MessageOf<C>> {
        self.ring.pop().ok()
    }

    /// Whether the loop is gone and everything it told was fetched.
    pub fn is_over(&self) -> bool {
        // In this order: what was told last was told before the loop left.
        self.ring.is_abandoned() && self.ring.is_empty()
    }
}

/// Ends a loop at its next tick, from any thread or from a signal handler.
#[derive(Clone, Debug, Default)]
pub struct StopHandle {
    flag: Arc<AtomicBool>,
}

impl StopHandle {
    /// Asks the loop to end. Async-signal-safe: a single atomic store.
    pub fn stop(&self) {
        self.flag.store(true, Ordering::Release);
    }

    /// Whether the loop was asked to end.
    pub fn is_set(&self) -> bool {
        self.flag.load(Ordering::Acquire)
    }

    /// The flag itself, for what registers flags with signals.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.flag)
    }
}
