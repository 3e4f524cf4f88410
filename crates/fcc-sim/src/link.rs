//! The state shared by sensor, actuator and observers of one simulation.
//!
//! The loop owns sensor and actuator separately and calls them in turn on one
//! thread, and neither may wait: commands are passed through atomics, the truth
//! through a sequence lock, whose writer never waits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU64, Ordering, fence};

use fcc_core::flight::Surfaces;
use fcc_core::framework::Switch;

use crate::truth::{NUMBERS, Truth};

/// The state shared by sensor, actuator and observers.
#[derive(Debug, Default)]
pub(crate) struct SharedState {
    /// Bits of throttle, elevator, aileron, rudder, elevator trim, flaps, brakes,
    /// nose wheel and gear, NaN for none.
    commands: [AtomicU64; 10],
    /// Whether the actuator holds the controls.
    held: AtomicBool,
    /// 0 by the script, 1 off, 2 on.
    switch: AtomicU8,
    /// Odd while the truth is being written.
    sequence: AtomicU64,
    truth: [AtomicU64; NUMBERS],
    /// Bits of the time of the impact, s; 0 before.
    impact: AtomicU64,
}

impl SharedState {
    /// Holds the controls at these commands. A concurrent reader in another
    /// thread may read a mixture of old and new commands.
    pub(crate) fn command(&self, surfaces: &Surfaces) {
        let given = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let values = [
            surfaces.throttle,
            surfaces.elevator,
            surfaces.aileron,
            surfaces.rudder,
            given(surfaces.elevator_trim),
            given(surfaces.flaps),
            given(surfaces.left_brake),
            given(surfaces.right_brake),
            given(surfaces.nose_wheel),
            given(surfaces.gear),
        ];
        for (place, value) in self.commands.iter().zip(values) {
            place.store(value.to_bits(), Ordering::Relaxed);
        }
        self.held.store(true, Ordering::Release);
    }

    /// Releases the controls.
    pub(crate) fn release(&self) {
        self.held.store(false, Ordering::Release);
    }

    /// The commands, if the actuator holds the controls.
    pub(crate) fn commands(&self) -> Option<Surfaces> {
        if !self.held.load(Ordering::Acquire) {
            return None;
        }
        let [
            throttle,
            elevator,
            aileron,
            rudder,
            trim,
            flaps,
            left,
            right,
            nose,
            gear,
        ] = self
            .commands
            .each_ref()
            .map(|place| f64::from_bits(place.load(Ordering::Relaxed)));
        let given = |value: f64| Some(value).filter(|value| !value.is_nan());
        Some(Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
            elevator_trim: given(trim),
            flaps: given(flaps),
            left_brake: given(left),
            right_brake: given(right),
            nose_wheel: given(nose),
            gear: given(gear),
        })
    }

    /// The position of the switch, if it was set by a handle.
    pub(crate) fn switch(&self) -> Option<Switch> {
        match self.switch.load(Ordering::Relaxed) {
            1 => Some(Switch::Off),
            2 => Some(Switch::On),
            _ => None,
        }
    }

    fn set_switch(&self, switch: Option<Switch>) {
        let code = match switch {
            None => 0,
            Some(Switch::Off) => 1,
            Some(Switch::On) => 2,
        };
        self.switch.store(code, Ordering::Relaxed);
    }

    /// Publishes a truth to the observers. One writer only.
    pub(crate) fn publish(&self, truth: &Truth) {
        let sequence = self.sequence.load(Ordering::Relaxed);
        self.sequence
            .store(sequence.wrapping_add(1), Ordering::Relaxed);
        fence(Ordering::Release);
        for (place, number) in self.truth.iter().zip(truth.to_array()) {
            place.store(number.to_bits(), Ordering::Relaxed);
        }
        self.sequence
            .store(sequence.wrapping_add(2), Ordering::Release);
    }

    /// The ground was hit at this time, s; the published truth is that of the
    /// impact.
    pub(crate) fn hit_ground(&self, at_s: f64) {
        self.impact.store(at_s.to_bits(), Ordering::Release);
    }

    fn impact_s(&self) -> Option<f64> {
        match self.impact.load(Ordering::Acquire) {
            0 => None,
            bits => Some(f64::from_bits(bits)),
        }
    }

    fn truth(&self) -> Truth {
        loop {
            let before = self.sequence.load(Ordering::Acquire);
            let numbers = self
                .truth
                .each_ref()
                .map(|place| f64::from_bits(place.load(Ordering::Relaxed)));
            fence(Ordering::Acquire);
            let after = self.sequence.load(Ordering::Relaxed);
            if before == after && before.is_multiple_of(2) {
                return Truth::from_array(numbers);
            }
            std::hint::spin_loop();
        }
    }
}

/// Sets the engage switch of a running simulation. Clones set the same switch,
/// from any thread.
#[derive(Clone, Debug)]
pub struct SwitchHandle(Arc<SharedState>);

impl SwitchHandle {
    pub(crate) fn new(link: Arc<SharedState>) -> Self {
        Self(link)
    }

    /// Sets the switch, overriding its script; `None` returns it to the script.
    pub fn set(&self, switch: Option<Switch>) {
        self.0.set_switch(switch);
    }
}

/// Reads the truth of a running simulation, from any thread: for scoring a
/// flight, never for controlling it.
#[derive(Clone, Debug)]
pub struct TruthHandle(Arc<SharedState>);

impl TruthHandle {
    pub(crate) fn new(link: Arc<SharedState>) -> Self {
        Self(link)
    }

    /// The truth after the last sample. Retries while one is being written,
    /// some ten nanoseconds.
    pub fn get(&self) -> Truth {
        self.0.truth()
    }

    /// The truth at the impact on the ground; none while it flies.
    pub fn impact(&self) -> Option<Truth> {
        let time_s = self.0.impact_s()?;
        Some(Truth {
            time_s,
            ..self.get()
        })
    }
}
