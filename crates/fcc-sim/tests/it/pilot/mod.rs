//! A simple controller for tests, sufficient to hold a steady state to be
//! measured.

use fcc_core::flight::Surfaces;
use fcc_sim::{Aircraft, Truth};

/// The controller with the state of its integrators.
#[derive(Default)]
pub(crate) struct Pilot {
    elevator: f64,
    aileron: f64,
    rudder: f64,
}

impl Pilot {
    /// Flies at a throttle and a bank for a time, at 40 Hz, with the pitch
    /// given by `wanted_pitch`.
    pub(crate) fn fly(
        &mut self,
        aircraft: &mut Aircraft,
        seconds: f64,
        throttle: f64,
        bank_rad: f64,
        wanted_pitch: impl Fn(&Truth) -> f64,
    ) {
        for _ in 0..(seconds * 40.0) as u32 {
            let now = aircraft.truth();
            let pitch_error = wanted_pitch(&now) - now.pitch_rad;
            let bank_error = bank_rad - now.roll_rad;
            self.elevator += 0.03 * pitch_error;
            self.aileron += 0.02 * bank_error;
            // Coordinate with the rudder towards the ball, which moves right
            // when the side force is to the left.
            self.rudder -= 0.002 * now.specific_force.y_mps2;
            let elevator = 2.0 * pitch_error + self.elevator - 0.5 * now.rates.pitch_radps;
            let aileron = 2.0 * bank_error + self.aileron - 0.3 * now.rates.roll_radps;
            aircraft.step(
                &Surfaces {
                    throttle,
                    elevator: elevator.clamp(-1.0, 1.0),
                    aileron: aileron.clamp(-1.0, 1.0),
                    rudder: (self.rudder + 2.0 * now.sideslip_rad).clamp(-1.0, 1.0),
                    ..Surfaces::IDLE
                },
                0.025,
            );
        }
    }
}
