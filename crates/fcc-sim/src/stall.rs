//! The moments of a stalled wing: autorotation, ailerons that lose their effect,
//! and a nose that drops.
//!
//! The linear derivatives hold for attached flow. In separated flow those that
//! are due to the wing's rotation and ailerons are replaced by strips along the
//! span: each has an angle of attack and an airspeed of its own, and the lift and
//! drag of the whole wing's curves there (Glauert, *The Rotation of an Aerofoil
//! about a Fixed Axis*, R&M 595, 1919; by Knight's wind-tunnel tests, NACA TR 273,
//! 1928, the polar suffices for the limits of autorotation). Beyond the stall the
//! falling wing loses lift and gains drag: the damping of roll changes its sign,
//! and the nose is drawn towards the falling wing.
//!
//! The tail feels the stall by the downwash that is lost: its angle of attack
//! rises, and the nose drops.

use libm::{atan2, exp, sincos, sqrt};
use nalgebra::Vector3;

use crate::airframe::{Airframe, Drag, Lift};
use crate::flow::Flow;

/// Sharpness of the stall, 1/rad: lift changes from one curve to the other
/// within about ±2° of the stall.
const STALL_SHARPNESS: f64 = 50.0;
/// Below the stalling angle by this, rad, no flow counts as separated: by the
/// curve it is less than 0.1 %.
const ATTACHED_BELOW_RAD: f64 = 0.14;
/// The strips' distances from the centre, in spans, on each side.
const STRIPS: [f64; 4] = [0.0625, 0.1875, 0.3125, 0.4375];
/// Each strip's share of the wing's area.
const SHARE: f64 = 0.125;
/// The ailerons are on the outer half of each wing, in spans from the centre.
const AILERON_FROM: f64 = 0.25;
/// The integral of the distance over their part of the span, in spans, both
/// sides: 2·∫ y dy from 1/4 to 1/2.
const AILERON_ARM: f64 = 0.1875;
/// Roll damping of strips per lift slope, without the loss at the tips (Etkin and
/// Reid 1996, section 5.8, constant chord).
const STRIP_DAMPING: f64 = 1.0 / 6.0;

/// Coefficients at an angle of attack.
pub(crate) struct Coefficients {
    pub(crate) lift: f64,
    pub(crate) drag: f64,
    /// The share of separated flow, 0..=1.
    pub(crate) separated: f64,
}

pub(crate) fn coefficients(
    lift: &Lift,
    drag: &Drag,
    alpha_rad: f64,
    (sin_alpha, cos_alpha): (f64, f64),
) -> Coefficients {
    let attached_lift = lift.zero + lift.per_alpha * alpha_rad;
    let attached_drag = drag.zero + drag.induced * attached_lift * attached_lift;

    let (sin_stall, cos_stall) = sincos(lift.stall_alpha_rad);
    let stall_drag = drag.zero + drag.induced * lift.stall * lift.stall;
    let plate = 1.11 + 0.018 * lift.aspect_ratio;
    let lift_rest =
        (lift.stall - plate * sin_stall * cos_stall) * sin_stall / (cos_stall * cos_stall);
    let drag_rest = (stall_drag - plate * sin_stall * sin_stall) / cos_stall;

    let square = sin_alpha * sin_alpha;
    // The published curve contains cos²/sin, which is valid only beyond the
    // stall.
    let separated_lift = plate * sin_alpha * cos_alpha
        + lift_rest * cos_alpha * cos_alpha * sin_alpha / square.max(sin_stall * sin_stall);
    let separated_drag = plate * square + drag_rest * cos_alpha.abs();

    let above = exp(-STALL_SHARPNESS * (alpha_rad - lift.stall_alpha_rad));
    let below = exp(STALL_SHARPNESS * (alpha_rad + lift.stall_alpha_rad));
    let separated = (1.0 + above + below) / ((1.0 + above) * (1.0 + below));
    Coefficients {
        lift: attached_lift + separated * (separated_lift - attached_lift),
        drag: attached_drag + separated * (separated_drag - attached_drag),
        separated,
    }
}

/// The wing by strips.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wing {
    /// How far the strips apply: the largest share of separated flow, 0..=1.
    pub(crate) separated: f64,
    /// Coefficients of their moments.
    pub(crate) rolling: f64,
    pub(crate) yawing: f64,
}

/// The wing at turn rates relative to the air in rad/s and an aileron in rad.
pub(crate) fn wing(
    airframe: &Airframe,
    flow: &Flow,
    rates: &Vector3<f64>,
    aileron_rad: f64,
) -> Wing {
    let (lift, drag) = (&airframe.lift, &airframe.drag);
    let roll = &airframe.lateral.roll;
    let speed = flow.symmetric_mps.max(1.0);
    // The loss at the tips, by the published damping.
    let of_strips = -roll.per_roll_rate / (STRIP_DAMPING * lift.per_alpha);
    // An aileron changes the angle of attack of its strips.
    let by_aileron = roll.per_aileron / (of_strips * AILERON_ARM * lift.per_alpha) * aileron_rad;
    let reach = flow.alpha_rad.abs()
        + 0.5 * airframe.wing_span_m * rates.x.abs() / speed
        + by_aileron.abs();
    let mut wing = Wing::default();
    if reach < lift.stall_alpha_rad - ATTACHED_BELOW_RAD {
        return wing;
    }
    let (sin_alpha, cos_alpha) = flow.sin_cos_alpha;
    for distance in STRIPS {
        for side in [-1.0, 1.0] {
            let arm = side * distance;
            let y_over_v = arm * airframe.wing_span_m / speed;
            let forward = cos_alpha - rates.z * y_over_v;
            let down = sin_alpha + rates.x * y_over_v;
            let pressure = forward * forward + down * down;
            let length = sqrt(pressure).max(1e-3);
            let (sin, cos) = (down / length, forward / length);
            let shift = if distance > AILERON_FROM {
                -side * by_aileron
            } else {
                0.0
            };
            let strip = coefficients(lift, drag, atan2(down, forward) + shift, (sin, cos));
            let share = of_strips * SHARE * arm * pressure;
            wing.rolling -= share * (strip.lift * cos + strip.drag * sin);
            wing.yawing -= share * (strip.lift * sin - strip.drag * cos);
            wing.separated = wing.separated.max(strip.separated);
        }
    }
    wing
}

/// Coefficient of the pitching moment that the lost downwash at the tail adds.
///
/// The downwash per angle of attack is the ratio of the moments due to the rates
/// of angle of attack and of pitch; the tail's moment per angle of attack is that
/// of pitch rate over twice its arm (Etkin and Reid 1996, sections 5.4 and 5.5).
pub(crate) fn pitching(airframe: &Airframe, alpha_rad: f64, whole: &Coefficients) -> f64 {
    let (lift, pitch) = (&airframe.lift, &airframe.pitch);
    if alpha_rad.abs() < lift.stall_alpha_rad - ATTACHED_BELOW_RAD {
        return 0.0;
    }
    let lost_lift = whole.lift - (lift.zero + lift.per_alpha * alpha_rad);
    let downwash_per_lift = pitch.per_alpha_rate / pitch.per_pitch_rate / lift.per_alpha;
    let tail = -pitch.per_pitch_rate * airframe.chord_m / (2.0 * pitch.tail_arm_m);
    tail * downwash_per_lift * lost_lift
}
