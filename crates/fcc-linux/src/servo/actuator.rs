//! The loop's end of servos.

use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Instant;

use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};
use rtrb::Producer;

use super::ServoControl;
use super::thread::{CONNECTED, NOT_OPEN, Order, PERMITTED, Shared};

/// How long the drop waits for the last pulses to be written.
const END_WITHIN: Duration = Duration::from_secs(1);

/// Servos as an actuator: hands each tick's outputs to the thread that writes them
/// ([`ServoThread`](super::ServoThread)).
///
/// A fault is that of the outputs before, which the thread has written meanwhile.
/// When it is dropped the servos are released, and the thread ends.
#[derive(Debug)]
pub struct ServoActuator {
    name: String,
    orders: Producer<Order>,
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
    is_held: bool,
}

impl ServoActuator {
    pub(super) const fn new(
        name: String,
        orders: Producer<Order>,
        shared: Arc<Shared>,
        thread: JoinHandle<()>,
    ) -> Self {
        Self {
            name,
            orders,
            shared,
            thread: Some(thread),
            is_held: false,
        }
    }

    /// Whether everything that was handed over has been written, or could not be.
    pub fn is_settled(&self) -> bool {
        self.shared.taken.load(Ordering::Acquire) == self.shared.given.load(Ordering::Acquire)
    }

    /// Control of the servos, for a [`ServoAuthority`](super::ServoAuthority).
    pub fn control(&self) -> ServoControl {
        ServoControl(Arc::clone(&self.shared))
    }

    /// Counts as held before the first pulse is written: what may have been taken
    /// must be released.
    fn take(&mut self) -> Result<(), ActuatorFault> {
        if self.is_held {
            return Ok(());
        }
        if self.shared.permission.load(Ordering::SeqCst) != PERMITTED {
            return Err(ActuatorFault::NotConnected);
        }
        self.shared.is_wanted.store(true, Ordering::SeqCst);
        if let Some((notice, plant)) = self.shared.notice.get() {
            notice.taking(plant);
        }
        self.is_held = true;
        Ok(())
    }

    fn give(&mut self, order: Order) -> Result<(), ActuatorFault> {
        // Full: the bus hangs.
        let given = self.orders.push(order);
        given.map_err(|_| ActuatorFault::Unconfirmed)?;
        self.shared.given.fetch_add(1, Ordering::Release);
        if let Some(thread) = &self.thread {
            thread.thread().unpark();
        }
        self.state()
    }

    /// How the outputs before were written.
    fn state(&self) -> Result<(), ActuatorFault> {
        match self.shared.state.load(Ordering::Acquire) {
            CONNECTED => Ok(()),
            NOT_OPEN => Err(ActuatorFault::NotConnected),
            errno => Err(ActuatorFault::Io { errno }),
        }
    }
}

impl Actuator<Surfaces> for ServoActuator {
    fn ready(&self) -> Result<(), ActuatorFault> {
        self.state()
    }

    fn apply(&mut self, _: &Tick, surfaces: &Surfaces) -> Result<(), ActuatorFault> {
        self.take()?;
        self.give(Order::Apply(*surfaces))
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        if self.is_held {
            self.give(Order::Release)?;
            self.is_held = false;
            self.shared.is_wanted.store(false, Ordering::SeqCst);
        }
        Ok(())
    }

    fn name(&self) -> &str {
        &self.name
    }
}

impl Drop for ServoActuator {
    fn drop(&mut self) {
        self.shared.end.store(true, Ordering::Release);
        let Some(thread) = self.thread.take() else {
            return;
        };
        let until = Instant::now() + END_WITHIN;
        while !thread.is_finished() && Instant::now() < until {
            thread.thread().unpark();
            thread::sleep(Duration::from_millis(1));
        }
    }
}
