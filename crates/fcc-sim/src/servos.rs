//! From commands to deflections: actuators with lag and a rate limit.

use fcc_core::flight::Surfaces;
use libm::exp;

use crate::aerodynamics::Deflections;
use crate::airframe::Travel;

/// The dynamics of an actuator.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Servo {
    /// First-order lag, s; 0 for none.
    pub lag_s: f64,
    /// Rate limit, in units of the command per second.
    pub rate_per_s: f64,
}

/// The actuators of an aircraft.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Servos {
    /// Elevator, aileron and rudder.
    pub surfaces: Servo,
    /// The throttle, with the engine's lag.
    pub throttle: Servo,
}

impl Default for Servos {
    /// Surfaces with a lag of 50 ms and half the travel in 0.4 s; an engine
    /// with a lag of half a second.
    fn default() -> Self {
        Self {
            surfaces: Servo {
                lag_s: 0.05,
                rate_per_s: 2.5,
            },
            throttle: Servo {
                lag_s: 0.5,
                rate_per_s: 1.0,
            },
        }
    }
}

impl Servos {
    /// The positions of the actuators after moving for `dt_s` towards
    /// `commands`.
    #[must_use]
    pub fn follow(&self, positions: &Surfaces, commands: &Surfaces, dt_s: f64) -> Surfaces {
        let surface = self.surfaces.prepared(dt_s);
        Surfaces {
            throttle: self
                .throttle
                .prepared(dt_s)
                .follow(positions.throttle, commands.throttle),
            elevator: surface.follow(positions.elevator, commands.elevator),
            aileron: surface.follow(positions.aileron, commands.aileron),
            rudder: surface.follow(positions.rudder, commands.rudder),
            elevator_trim: commands.elevator_trim.or(positions.elevator_trim),
            flaps: commands.flaps.or(positions.flaps),
            left_brake: commands.left_brake.or(positions.left_brake),
            right_brake: commands.right_brake.or(positions.right_brake),
            nose_wheel: commands.nose_wheel.or(positions.nose_wheel),
            gear: commands.gear.or(positions.gear),
        }
    }
}

impl Servo {
    fn prepared(&self, dt_s: f64) -> Prepared {
        Prepared {
            share: if self.lag_s > 0.0 {
                1.0 - exp(-dt_s / self.lag_s)
            } else {
                1.0
            },
            most: self.rate_per_s * dt_s,
        }
    }
}

/// A servo's step of a given length, so that the exponential is computed once.
struct Prepared {
    share: f64,
    most: f64,
}

impl Prepared {
    fn follow(&self, position: f64, command: f64) -> f64 {
        let way = (command - position) * self.share;
        position + way.max(-self.most).min(self.most)
    }
}

/// Deflections from actuator positions -1..=1 and the elevator in rad at which
/// they begin, within the travel. The trim moves the elevator as far as the
/// elevator's own command does. +elevator raises the nose, +aileron rolls right, +rudder
/// yaws right; the derivatives' own signs differ for elevator and rudder.
pub fn deflections(travel: &Travel, positions: &Surfaces, elevator_trim_rad: f64) -> Deflections {
    let elevator = positions.elevator + positions.elevator_trim.unwrap_or(0.0);
    let elevator_travel = if elevator >= 0.0 {
        travel.elevator_up_rad
    } else {
        travel.elevator_down_rad
    };
    Deflections {
        elevator_rad: (elevator_trim_rad - elevator * elevator_travel)
            .max(-travel.elevator_up_rad)
            .min(travel.elevator_down_rad),
        aileron_rad: positions.aileron * travel.aileron_rad,
        rudder_rad: -positions.rudder * travel.rudder_rad,
        throttle: positions.throttle,
    }
}
