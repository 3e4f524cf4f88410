//! Who has control of servos, seen from outside the loop.

use core::fmt;
use core::sync::atomic::Ordering;
use core::time::Duration;
use std::sync::Arc;

use fcc_core::framework::{ActuatorFault, ControlAuthority, PlantId, Released, TakeoverNotice};

use super::thread::{PERMITTED, PERMITTED_AFTER_CHECK, Shared};
use crate::DeviceError;

/// Control of the servos of one [`ServoActuator`](super::ServoActuator), for a
/// [`ServoAuthority`].
#[derive(Clone, Debug)]
pub struct ServoControl(pub(super) Arc<Shared>);

/// Writes the pulses of released servos, by outputs of its own.
pub type ReleasePulses = Box<dyn Fn() -> Result<(), DeviceError> + Send + Sync>;

/// Monitors who has control of servos, and releases them by outputs of its own:
/// also from another process, since PWM goes on with its last pulses when the
/// process that wrote them was killed.
pub struct ServoAuthority {
    plant: PlantId,
    controls: Vec<ServoControl>,
    releases: Vec<ReleasePulses>,
}

impl fmt::Debug for ServoAuthority {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ServoAuthority")
            .field("plant", &self.plant)
            .field("controls", &self.controls)
            .finish_non_exhaustive()
    }
}

impl ServoAuthority {
    /// For servos with this name; `controls` is empty in a program that controls
    /// nothing itself, and only releases what another program held.
    pub fn new(plant: PlantId, controls: Vec<ServoControl>, releases: Vec<ReleasePulses>) -> Self {
        Self {
            plant,
            controls,
            releases,
        }
    }

    fn each(&self) -> impl Iterator<Item = &Shared> {
        self.controls.iter().map(|control| control.0.as_ref())
    }
}

impl ControlAuthority for ServoAuthority {
    fn plant(&self) -> Option<PlantId> {
        Some(self.plant)
    }

    fn held(&self) -> Option<PlantId> {
        self.each().any(Shared::is_held).then_some(self.plant)
    }

    fn require_permission(&self) {
        for shared in self.each() {
            shared
                .permission
                .store(PERMITTED_AFTER_CHECK, Ordering::SeqCst);
        }
    }

    fn permit(&self, plant: &PlantId) {
        if *plant == self.plant {
            for shared in self.each() {
                shared.permission.store(PERMITTED, Ordering::SeqCst);
            }
        }
    }

    fn notify(&self, notice: &'static dyn TakeoverNotice) {
        for shared in self.each() {
            let _ = shared.notice.set((notice, self.plant));
        }
    }

    /// The servos' thread reports what is wrong.
    fn report(&self, _: &mut dyn FnMut(fmt::Arguments<'_>)) {}

    /// Confirmed when the pulses were written: servos answer nothing.
    fn release(
        &self,
        plant: &PlantId,
        _within: Duration,
        is_cancelled: &mut dyn FnMut() -> bool,
    ) -> Result<Released, ActuatorFault> {
        if *plant != self.plant {
            return Err(ActuatorFault::NotConnected);
        }
        if is_cancelled() {
            return Ok(Released::Cancelled);
        }
        // Each is tried, whatever becomes of the others.
        let written = self.releases.iter().map(|release| release());
        let failed: Vec<DeviceError> = written.filter_map(Result::err).collect();
        match failed.first() {
            Some(error) => Err(ActuatorFault::Io {
                errno: error.errno(),
            }),
            None => Ok(Released::Confirmed),
        }
    }

    fn by_hand(&self) -> &'static str {
        "take the servos back by the multiplexer, or switch off their supply"
    }
}
