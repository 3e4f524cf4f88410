//! The values that X-Plane reports back of what is written to it.

use core::sync::atomic::{AtomicI64, AtomicU32, Ordering};

use fcc_core::framework::Time;

use crate::quantity::Quantity;

/// A value reported by the simulator and its time.
#[derive(Debug)]
struct Readback {
    bits: AtomicU32,
    at: AtomicI64,
}

impl Readback {
    const fn never() -> Self {
        Self {
            bits: AtomicU32::new(0),
            at: AtomicI64::new(Time::NEVER.as_nanos()),
        }
    }
}

/// The quantities that are written to X-Plane and read back, and where a
/// released throttle returns to.
const READ_BACK: [Quantity; 6] = [
    Quantity::OverrideJoystick,
    Quantity::OverrideThrottles,
    Quantity::YokePitch,
    Quantity::YokeRoll,
    Quantity::YokeHeading,
    Quantity::ThrottleLever,
];

/// The last readback of each of these quantities.
#[derive(Debug)]
pub(crate) struct Readbacks {
    slots: [Readback; READ_BACK.len()],
}

impl Readbacks {
    pub(crate) const fn never() -> Self {
        Self {
            slots: [const { Readback::never() }; READ_BACK.len()],
        }
    }

    fn slot(&self, quantity: Quantity) -> Option<&Readback> {
        let index = READ_BACK.iter().position(|of| *of == quantity)?;
        self.slots.get(index)
    }

    /// Stores a readback; quantities that are not read back are ignored.
    pub(crate) fn show(&self, quantity: Quantity, value: f64, at: Time) {
        if let Some(slot) = self.slot(quantity) {
            slot.bits.store((value as f32).to_bits(), Ordering::Relaxed);
            slot.at.store(at.as_nanos(), Ordering::Release);
        }
    }

    /// The simulator's last readback, and its time.
    pub(crate) fn shown(&self, quantity: Quantity) -> Option<(f32, Time)> {
        let slot = self.slot(quantity)?;
        let at = Time::from_nanos(slot.at.load(Ordering::Acquire));
        let value = f32::from_bits(slot.bits.load(Ordering::Relaxed));
        (!at.is_never()).then_some((value, at))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_readback_is_kept_with_its_time() {
        let readbacks = Readbacks::never();
        assert_eq!(readbacks.shown(Quantity::YokeRoll), None);
        readbacks.show(Quantity::YokeRoll, -0.25, Time::from_nanos(7));
        assert_eq!(
            readbacks.shown(Quantity::YokeRoll),
            Some((-0.25, Time::from_nanos(7)))
        );
    }
}
