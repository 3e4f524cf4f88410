//! Trim: the controls that hold an aircraft in straight and level flight.

use libm::{cos, sin, sincos};
use thiserror::Error;

use crate::aerodynamics::{full_thrust_n, lift_and_drag, windmill_n};
use crate::airframe::Airframe;
use crate::atmosphere::Air;
use crate::stall;
use crate::stall::coefficients;

/// Straight and level flight in still air.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Trim {
    /// Angle of attack, in level flight equal to pitch, rad.
    pub alpha_rad: f64,
    /// Elevator, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Throttle, 0..=1.
    pub throttle: f64,
    /// True airspeed, m/s.
    pub true_airspeed_mps: f64,
    /// Thrust, N.
    pub thrust_n: f64,
}

/// Why there is no trim.
#[derive(Clone, Copy, PartialEq, Debug, Error)]
#[non_exhaustive]
pub enum TrimError {
    /// The wing cannot provide the lift.
    #[error(
        "cannot fly level at {indicated_mps:.1} m/s indicated: the wing stalls; \
         choose a higher airspeed"
    )]
    TooSlow {
        /// The requested airspeed, m/s indicated.
        indicated_mps: f64,
    },
    /// The engine cannot hold the speed, or exceeds it even at idle.
    #[error(
        "cannot hold {indicated_mps:.1} m/s indicated at {altitude_m:.0} m: it takes a \
         throttle of {throttle:.2} (0..1); choose a lower airspeed or altitude"
    )]
    Throttle {
        /// The requested airspeed, m/s indicated.
        indicated_mps: f64,
        /// The requested altitude, m.
        altitude_m: f64,
        /// The throttle that would be required.
        throttle: f64,
    },
    /// The elevator's travel does not suffice.
    #[error(
        "cannot hold {indicated_mps:.1} m/s indicated: it takes {elevator_rad:.3} rad of \
         elevator, more than its travel; choose an airspeed nearer to cruise"
    )]
    Elevator {
        /// The requested airspeed, m/s indicated.
        indicated_mps: f64,
        /// The deflection that would be required, rad, positive trailing edge
        /// down.
        elevator_rad: f64,
    },
}

/// Trims for straight and level flight at an indicated airspeed in m/s and an
/// altitude in m.
///
/// For each angle of attack the moments determine the elevator and drag the
/// thrust. One equation in one unknown remains, lift against weight, which is
/// monotonic up to the stall, so that bisection always converges.
///
/// # Errors
/// [`TrimError`] if the wing, the engine or the elevator does not suffice.
pub fn trim(airframe: &Airframe, indicated_mps: f64, altitude_m: f64) -> Result<Trim, TrimError> {
    /// Bound of the search: beyond the angle of level flight at any speed, rad.
    const LOWEST_ALPHA_RAD: f64 = -0.15;
    /// Steps from the lowest angle up to the stall in search of a bracket.
    const SCAN: u32 = 64;
    /// Bisection steps: from 0.01 rad to below the last digit.
    const HALVINGS: u32 = 60;

    let air = Air::at(altitude_m);
    let speed = air.true_of_indicated_mps(indicated_mps);
    let pressure_area = 0.5 * air.density_kgpm3 * speed * speed * airframe.wing_area_m2;
    let elevator = |alpha: f64| {
        let wing = coefficients(&airframe.lift, &airframe.drag, alpha, sincos(alpha));
        let stalled = stall::pitching(airframe, alpha, &wing);
        -(airframe.pitch.zero + airframe.pitch.per_alpha * alpha + stalled)
            / airframe.pitch.per_elevator
    };
    let thrust = |alpha: f64| {
        let (_, drag) = lift_and_drag(&airframe.lift, &airframe.drag, alpha);
        pressure_area * drag / cos(alpha)
    };
    let surplus = |alpha: f64| {
        let (lift, _) = lift_and_drag(&airframe.lift, &airframe.drag, alpha);
        let total = lift + airframe.pitch.lift_per_elevator * elevator(alpha);
        pressure_area * total + thrust(alpha) * sin(alpha) - airframe.weight_n()
    };

    // The lowest angle whose lift equals the weight: the one before the stall.
    let stride = (airframe.lift.stall_alpha_rad + 0.05 - LOWEST_ALPHA_RAD) / f64::from(SCAN);
    let mut high = None;
    for index in 1..=SCAN {
        let alpha = LOWEST_ALPHA_RAD + stride * f64::from(index);
        if surplus(alpha) >= 0.0 {
            high = Some(alpha);
            break;
        }
    }
    let Some(mut high) = high else {
        return Err(TrimError::TooSlow { indicated_mps });
    };
    let mut low = high - stride;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if surplus(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let alpha_rad = 0.5 * (low + high);
    checked(
        airframe,
        &air,
        indicated_mps,
        altitude_m,
        Trim {
            alpha_rad,
            elevator_rad: elevator(alpha_rad),
            throttle: 0.0,
            true_airspeed_mps: speed,
            thrust_n: thrust(alpha_rad),
        },
    )
}

/// The trim with its throttle, if engine and elevator suffice.
fn checked(
    airframe: &Airframe,
    air: &Air,
    indicated_mps: f64,
    altitude_m: f64,
    trim: Trim,
) -> Result<Trim, TrimError> {
    let propulsion = &airframe.propulsion;
    let torque_n = trim.thrust_n - windmill_n(propulsion, trim.true_airspeed_mps, air);
    let throttle = torque_n / full_thrust_n(propulsion, air);
    if !(0.0..=1.0).contains(&throttle) {
        return Err(TrimError::Throttle {
            indicated_mps,
            altitude_m,
            throttle,
        });
    }
    let travel = &airframe.travel;
    if !(-travel.elevator_up_rad..=travel.elevator_down_rad).contains(&trim.elevator_rad) {
        return Err(TrimError::Elevator {
            indicated_mps,
            elevator_rad: trim.elevator_rad,
        });
    }
    Ok(Trim { throttle, ..trim })
}
