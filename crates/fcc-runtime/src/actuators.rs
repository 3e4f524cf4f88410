//! The loop's actuators: driven, monitored, and released on every exit path.

use fcc_core::framework::{Actuator, ActuatorFault, EventKind, Tick};

use crate::faults::{Change, Health};
use crate::panics;
use crate::telemetry_producer::Events;

struct Watched<A> {
    actuator: Box<dyn Actuator<A>>,
    health: Health<ActuatorFault>,
    /// A release was requested and failed.
    release_pending: bool,
}

impl<A> Watched<A> {
    fn note<O>(
        &mut self,
        index: u16,
        result: Result<(), ActuatorFault>,
        tick: &Tick,
        events: &mut Events<O>,
    ) {
        match self.health.update(result) {
            Some(Change::Fault(fault)) => {
                events.push(tick, EventKind::ActuatorFault { index, fault });
            }
            Some(Change::Recovered) => events.push(tick, EventKind::ActuatorRecovered { index }),
            None => {}
        }
    }
}

/// The loop's actuators.
pub(crate) struct Actuators<A> {
    all: Vec<Watched<A>>,
    faults: u64,
}

impl<A> Actuators<A> {
    pub(crate) fn new(actuators: Vec<Box<dyn Actuator<A>>>) -> Self {
        let watched = |actuator| Watched {
            actuator,
            health: Health::new(),
            release_pending: false,
        };
        Self {
            all: actuators.into_iter().map(watched).collect(),
            faults: 0,
        }
    }

    /// Whether every actuator could take control now; what is wrong is an event of
    /// each that could not.
    pub(crate) fn are_ready<O>(&mut self, tick: &Tick, events: &mut Events<O>) -> bool {
        let mut all = true;
        for (index, watched) in (0..).zip(&mut self.all) {
            let ready = watched.actuator.ready();
            if ready.is_err() {
                all = false;
                watched.note(index, ready, tick, events);
            }
        }
        all
    }

    /// Passes the outputs to every actuator, even if one fails.
    pub(crate) fn apply<O>(&mut self, tick: &Tick, outputs: &A, events: &mut Events<O>) {
        for (index, watched) in (0..).zip(&mut self.all) {
            let result = watched.actuator.apply(tick, outputs);
            self.faults += u64::from(result.is_err());
            watched.note(index, result, tick, events);
        }
    }

    /// Warms every actuator up for this tick, without effect.
    pub(crate) fn warm_up(&self, tick: &Tick, outputs: &A) {
        for watched in &self.all {
            watched.actuator.warm_up(tick, outputs);
        }
    }

    /// Requests every actuator to give control back, even if one fails or
    /// panics.
    ///
    /// # Errors
    /// The message of the first panic.
    pub(crate) fn release<O>(&mut self, tick: &Tick, events: &mut Events<O>) -> Result<(), String> {
        let mut panic = Ok(());
        for (index, watched) in (0..).zip(&mut self.all) {
            match panics::caught(|| watched.actuator.release()) {
                Ok(result) => {
                    // A successful release does not end the fault of a write.
                    if result.is_err() || watched.release_pending {
                        watched.note(index, result, tick, events);
                    }
                    watched.release_pending = result.is_err();
                    self.faults += u64::from(result.is_err());
                }
                Err(words) => {
                    watched.release_pending = true;
                    panic = panic.and(Err(words));
                }
            }
        }
        panic
    }

    /// Whether every release succeeded.
    pub(crate) fn are_released(&self) -> bool {
        self.all.iter().all(|watched| !watched.release_pending)
    }

    /// Failed writes and releases since the start.
    pub(crate) const fn faults(&self) -> u64 {
        self.faults
    }
}
