//! The caller's ends of a loop's two rings, and its stop flag.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use fcc_core::framework::{Controller, LoopCommand, MessageOf};
use rtrb::{Consumer, Producer};

use crate::heartbeat::Heartbeat;

/// A loop's connections to its caller.
pub struct Link<C: Controller> {
    /// Commands in.
    pub commands: CommandSender<C::Command>,
    /// Records and events out.
    pub messages: MessageReceiver<C>,
    /// The stop flag.
    pub stop: StopHandle,
    /// Whether the loop makes progress.
    pub heartbeat: Heartbeat,
}

/// Sends commands to a loop; never waits.
pub struct CommandSender<O> {
    ring: Producer<LoopCommand<O>>,
}

impl<O> CommandSender<O> {
    pub(crate) const fn new(ring: Producer<LoopCommand<O>>) -> Self {
        Self { ring }
    }

    /// How many commands can be sent now, 0 if the loop is over: for those that
    /// mean something only together.
    pub fn room(&self) -> usize {
        if self.ring.is_abandoned() {
            0
        } else {
            self.ring.slots()
        }
    }

    /// Sends a command; it is read in one of the next ticks.
    ///
    /// # Errors
    /// The command itself, if the ring is full or the loop has ended.
    pub fn send(&mut self, command: LoopCommand<O>) -> Result<(), CommandsFull<O>> {
        if self.ring.is_abandoned() {
            return Err(CommandsFull(command));
        }
        self.ring
            .push(command)
            .map_err(|rtrb::PushError::Full(command)| CommandsFull(command))
    }
}

/// A command that could not be sent: the ring is full, or the loop has ended.
#[derive(thiserror::Error, Clone, Copy, PartialEq, Eq, Debug)]
#[error(
    "the loop takes no more commands now: it is over, or many wait; send again in the next tick"
)]
pub struct CommandsFull<O>(pub LoopCommand<O>);

/// Receives a loop's messages; never waits.
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

    /// Whether the loop has ended and all messages were received.
    pub fn is_over(&self) -> bool {
        // In this order: the last message was sent before the loop ended.
        self.ring.is_abandoned() && self.ring.is_empty()
    }
}

/// Ends a loop at its next tick, from any thread or from a signal handler.
#[derive(Clone, Debug, Default)]
pub struct StopHandle {
    flag: Arc<AtomicBool>,
}

impl StopHandle {
    /// Requests the loop to end. Async-signal-safe: a single atomic store.
    pub fn stop(&self) {
        self.flag.store(true, Ordering::Release);
    }

    /// Whether the loop was requested to end.
    pub fn is_set(&self) -> bool {
        self.flag.load(Ordering::Acquire)
    }

    /// The flag itself, to register with a signal handler.
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.flag)
    }
}
