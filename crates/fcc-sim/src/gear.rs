//! The landing gear: three wheels on level ground.
//!
//! A wheel's normal force is that of a spring with a damper; its friction is along the
//! wheel, by rolling and brake, and across it, by the angle of its slip, up to that of
//! a dry runway (Stevens, Lewis and Johnson 2016 leave the gear out; the form is that of
//! Phillips, NASA TN D-7703, 1974: cornering proportional to the slip up to a limit).

use nalgebra::Vector3;

use crate::state::State;

/// A wheel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Wheel {
    /// Where it touches the ground without load, from the centre of gravity, body
    /// axes, m.
    pub at_m: Vector3<f64>,
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
}

/// A tricycle gear with a steered nose wheel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gear {
    /// In front.
    pub nose: Wheel,
    /// To the right; the left one is its mirror image.
    pub main: Wheel,
    /// The nose wheel's largest deflection, rad.
    pub steering_rad: f64,
}

/// What moves the wheels, and where the ground is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Ground {
    /// Above mean sea level, m.
    pub altitude_m: f64,
    /// Brakes of the left and the right wheel, 0..=1.
    pub brakes: [f64; 2],
    /// Of the nose wheel, -1..=1, to the right.
    pub steering: f64,
}

/// Friction of a tyre that rolls, that is braked fully, and across, on dry asphalt
/// (14 CFR 25.109 and 23.735 assume 0.8 at low speed for the tyre).
const ROLLING: f64 = 0.02;
const BRAKED: f64 = 0.6;
const ACROSS: f64 = 0.7;
/// The slip at which a tyre gives all of it, rad, and the speed below which friction
/// falls to nothing, m/s.
const FULL_SLIP_RAD: f64 = 0.14;
const CREEPS_MPS: f64 = 0.3;
/// Nearer to the ground than this the wheels are looked at, m.
const NEAR_M: f64 = 4.0;
/// What the gear withstands, m/s: 10 ft/s, the most that 14 CFR 23.473 asks for.
pub(crate) const MOST_SINK_MPS: f64 = 3.05;

impl Gear {
    /// Of a Cessna 172: wheelbase 65 inches, track 100 inches (its handbook, figure
    /// 1-1), the nose wheel turns by 10° with the pedals; a load of 1 g compresses
    /// it by some 0.1 m.
    pub const CESSNA_172: Self = Self {
        nose: Wheel {
            at_m: Vector3::new(1.25, 0.0, 1.35),
            stiffness: 26_000.0,
            damping: 5_000.0,
        },
        main: Wheel {
            at_m: Vector3::new(-0.4, 1.27, 1.35),
            stiffness: 40_000.0,
            damping: 8_000.0,
        },
        steering_rad: 0.174_533,
    };

    fn wheels(&self, ground: &Ground) -> [(Wheel, f64, f64); 3] {
        let mut left = self.main;
        left.at_m.y = -left.at_m.y;
        let [left_brake, right_brake] = ground.brakes;
        let steered_rad = self.steering_rad * ground.steering;
        [
            (self.nose, 0.0, steered_rad),
            (left, left_brake, 0.0),
            (self.main, right_brake, 0.0),
        ]
    }

    /// Whether a wheel bears weight.
    pub fn touches(&self, state: &State, ground: &Ground) -> bool {
        state.altitude_m() - ground.altitude_m < NEAR_M
            && self.wheels(ground).iter().any(|(wheel, ..)| {
                let at = state.position_m + state.attitude.transform_vector(&wheel.at_m);
                at.z + ground.altitude_m > 0.0
            })
    }

    /// Force and moment on the aircraft, body axes, N and N m.
    pub fn loads(&self, state: &State, ground: &Ground) -> (Vector3<f64>, Vector3<f64>) {
        let mut force = Vector3::zeros();
        let mut moment = Vector3::zeros();
        if state.altitude_m() - ground.altitude_m > NEAR_M {
            return (force, moment);
        }
        let nose = state.attitude.transform_vector(&Vector3::x());
        for (wheel, brake, steered_rad) in self.wheels(ground) {
            let arm = state.attitude.transform_vector(&wheel.at_m);
            let pressed_m = state.position_m.z + arm.z + ground.altitude_m;
            if pressed_m <= 0.0 {
                continue;
            }
            let turning = state.attitude.transform_vector(&state.rates_radps);
            let velocity = state.velocity_mps + turning.cross(&arm);
            let normal_n = (wheel.stiffness * pressed_m + wheel.damping * velocity.z).max(0.0);
            let (sin, cos) = libm::sincos(steered_rad);
            let length = libm::hypot(nose.x, nose.y).max(1e-6);
            let (ahead_x, ahead_y) = (nose.x / length, nose.y / length);
            let along = Vector3::new(
                ahead_x * cos - ahead_y * sin,
                ahead_y * cos + ahead_x * sin,
                0.0,
            );
            let across = Vector3::new(-along.y, along.x, 0.0);
            let (rolls, slips) = (velocity.dot(&along), velocity.dot(&across));
            let rolling = (ROLLING + BRAKED * brake) * (rolls / CREEPS_MPS).clamp(-1.0, 1.0);
            let full_mps = (FULL_SLIP_RAD * rolls.abs()).max(CREEPS_MPS);
            let slipping = ACROSS * (slips / full_mps).clamp(-1.0, 1.0);
            let on_wheel = Vector3::new(0.0, 0.0, -normal_n)
                - along * (rolling * normal_n)
                - across * (slipping * normal_n);
            let in_body = state.attitude.inverse_transform_vector(&on_wheel);
            force += in_body;
            moment += (wheel.at_m + Vector3::new(0.0, 0.0, -pressed_m)).cross(&in_body);
        }
        (force, moment)
    }
}
