//! Forces and moments of the air and the propeller on the airframe.
//!
//! Published linear derivatives, with two non-linear curves where they are
//! needed: lift through the stall and drag over lift. The moments of the stalled
//! wing are in `stall`. Derivatives are taken to
//! hold in body axes; the source's stability axes coincide with them at its
//! reference of zero angle of attack.

use libm::sincos;
use nalgebra::Vector3;

use crate::airframe::{Airframe, Drag, LateralRow, Lift, Propulsion};
use crate::atmosphere::Air;
pub use crate::flow::Flow;
use crate::flow::SLOWEST_MPS;
use crate::stall::{self, coefficients};

/// The present deflections of the controls. Signs are those of the source: see
/// each field.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Deflections {
    /// Elevator, rad, positive trailing edge down: nose down.
    pub elevator_rad: f64,
    /// Aileron, rad, positive rolls right.
    pub aileron_rad: f64,
    /// Rudder, rad, positive trailing edge left: nose left.
    pub rudder_rad: f64,
    /// Share of the torque the engine has at this density, 0..=1.
    pub throttle: f64,
}

/// Forces in N and moments in N·m, in body axes, and their derivatives with
/// respect to the rate of the angle of attack.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Loads {
    /// Force of air and propeller, without the part due to `alpha_rate`.
    pub force_n: Vector3<f64>,
    /// Moment, without the part due to `alpha_rate`.
    pub moment_nm: Vector3<f64>,
    /// Lift per angle-of-attack rate, N·s/rad.
    pub lift_per_alpha_rate: f64,
    /// Pitching moment per angle-of-attack rate, N·m·s/rad.
    pub pitch_per_alpha_rate: f64,
}

/// Loads at a flow, turn rates relative to the air in rad/s (body axes),
/// deflections and air.
pub fn loads(
    airframe: &Airframe,
    flow: &Flow,
    rates: &Vector3<f64>,
    deflections: &Deflections,
    air: &Air,
) -> Loads {
    let speed = flow.airspeed_mps.max(SLOWEST_MPS);
    let pressure_area =
        0.5 * air.density_kgpm3 * flow.airspeed_mps * flow.airspeed_mps * airframe.wing_area_m2;
    let half_chord_time = airframe.chord_m / (2.0 * speed);
    let half_span_time = airframe.wing_span_m / (2.0 * speed);
    let pitch = &airframe.pitch;

    let whole = coefficients(
        &airframe.lift,
        &airframe.drag,
        flow.alpha_rad,
        flow.sin_cos_alpha,
    );
    // Flow along the wing presses nothing: of separated flow only the part across it counts
    // (the independence principle, Schlichting 1979, chapter XI).
    let across = flow.symmetric_mps / speed;
    let pressed = 1.0 - whole.separated * (1.0 - across * across);
    let drag = pressed * whole.drag;
    let lift = pressed * whole.lift
        + pitch.lift_per_pitch_rate * rates.y * half_chord_time
        + pitch.lift_per_elevator * deflections.elevator_rad;
    // In separated flow surfaces are plates: in flow from behind neither wing nor tail has
    // the angle of attack of half a turn.
    let angle_rad = flow.alpha_rad + whole.separated * (flow.sin_cos_alpha.0 - flow.alpha_rad);
    let pitching = pitch.zero
        + pressed * pitch.per_alpha * angle_rad
        + pitch.per_pitch_rate * rates.y * half_chord_time
        + pitch.per_elevator * deflections.elevator_rad
        + pressed * stall::pitching(airframe, angle_rad, &whole);
    let wing = stall::wing(airframe, flow, rates, deflections.aileron_rad);
    // What is due to the wing's rotation and ailerons is the strips' in separated
    // flow; sideslip, rudder and the tail's yaw damping stay.
    let lateral = |row: &LateralRow, yaw_rate_by_wing: f64| {
        let by_wing = row.per_roll_rate * rates.x * half_span_time
            + yaw_rate_by_wing * rates.z * half_span_time
            + row.per_aileron * deflections.aileron_rad;
        row.per_beta * flow.beta_rad
            + (row.per_yaw_rate - yaw_rate_by_wing) * rates.z * half_span_time
            + row.per_rudder * deflections.rudder_rad
            + (1.0 - wing.separated) * by_wing
    };
    let (side, roll, yaw) = {
        let rows = &airframe.lateral;
        (
            lateral(&rows.side, 0.0),
            lateral(&rows.roll, rows.roll.per_yaw_rate)
                + wing.separated * across * across * wing.rolling,
            lateral(&rows.yaw, 0.0) + wing.separated * across * across * wing.yawing,
        )
    };

    let (sin_alpha, cos_alpha) = flow.sin_cos_alpha;
    let thrust = thrust_n(
        &airframe.propulsion,
        deflections.throttle,
        flow.airspeed_mps,
        air,
    );
    Loads {
        force_n: Vector3::new(
            pressure_area * (lift * sin_alpha - drag * cos_alpha) + thrust,
            pressure_area * side,
            pressure_area * (-lift * cos_alpha - drag * sin_alpha),
        ),
        moment_nm: Vector3::new(
            pressure_area * airframe.wing_span_m * roll,
            pressure_area * airframe.chord_m * pitching,
            pressure_area * airframe.wing_span_m * yaw,
        ),
        lift_per_alpha_rate: pressure_area * half_chord_time * pitch.lift_per_alpha_rate,
        pitch_per_alpha_rate: pressure_area
            * airframe.chord_m
            * half_chord_time
            * pitch.per_alpha_rate,
    }
}

/// Lift and drag coefficients over angle of attack, neutral elevator.
///
/// Below the stall a line and a parabola; beyond it the curves of Viterna and
/// Corrigan (NASA CP-2230, 1982), which extend to 90°. The sigmoid in Beard's
/// *Small Unmanned Aircraft* (2012, eq. 4.10) blends the two, so that the
/// result is smooth.
pub fn lift_and_drag(lift: &Lift, drag: &Drag, alpha_rad: f64) -> (f64, f64) {
    let coefficients = coefficients(lift, drag, alpha_rad, sincos(alpha_rad));
    (coefficients.lift, coefficients.drag)
}

/// Thrust along body x, N, at a true airspeed in m/s. Negative where the
/// propeller windmills.
pub fn thrust_n(propulsion: &Propulsion, throttle: f64, airspeed_mps: f64, air: &Air) -> f64 {
    full_thrust_n(propulsion, air) * throttle + windmill_n(propulsion, airspeed_mps, air)
}

/// The part of the thrust due to the engine's torque at full throttle, N.
pub(crate) fn full_thrust_n(propulsion: &Propulsion, air: &Air) -> f64 {
    let torque_nm = propulsion.rated_torque_nm * torque_ratio(propulsion, air);
    core::f64::consts::TAU * propulsion.polar_slope * torque_nm / propulsion.diameter_m
}

/// The part that depends on airspeed, N; negative.
pub(crate) fn windmill_n(propulsion: &Propulsion, airspeed_mps: f64, air: &Air) -> f64 {
    let disc = propulsion.diameter_m * airspeed_mps;
    propulsion.polar_intercept * air.density_kgpm3 * disc * disc
}

/// Torque at full throttle relative to sea level.
pub fn torque_ratio(propulsion: &Propulsion, air: &Air) -> f64 {
    let share = propulsion.friction_share;
    ((air.density_ratio() - share) / (1.0 - share)).max(0.0)
}
