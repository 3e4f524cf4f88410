//! The rigid body's six degrees of freedom, and their integration.
//!
//! Position and velocity are in north-east-down axes of a flat, non-rotating
//! earth, attitude is a quaternion from body to those axes, turn rates are in
//! body axes (Stevens, Lewis and Johnson, *Aircraft Control and Simulation*,
//! 2016, ch. 1). Four-stage Runge-Kutta: at 120 Hz its error in the fastest
//! mode, roll with about 13 1/s, is 10⁻⁷ per step.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::aerodynamics::{self, Deflections, Flow};
use crate::airframe::Airframe;
use crate::atmosphere::Air;
use crate::gear::Ground;
pub use crate::state::{AirMotion, State};
use crate::units::STANDARD_GRAVITY_MPS2;

/// The time derivative of a [`State`], and the specific force.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Derivative {
    /// Velocity over the ground, m/s.
    pub velocity_mps: Vector3<f64>,
    /// Acceleration, north-east-down, m/s².
    pub acceleration_mps2: Vector3<f64>,
    /// Of the attitude's quaternion, 1/s.
    pub attitude: Quaternion<f64>,
    /// Angular acceleration, body axes, rad/s².
    pub angular_radps2: Vector3<f64>,
    /// Specific force (acceleration minus gravity), body axes, m/s².
    pub specific_force_mps2: Vector3<f64>,
}

impl State {
    /// The state after `dt_s`, with deflections and air held; with `ground` its wheels
    /// can stand on it.
    #[must_use]
    pub fn after(
        &self,
        dt_s: f64,
        airframe: &Airframe,
        deflections: &Deflections,
        motion: &AirMotion,
        air: &Air,
        ground: Option<&Ground>,
    ) -> Self {
        let slope = |state: &Self| derivative(airframe, state, deflections, motion, air, ground);
        let k1 = slope(self);
        let k2 = slope(&self.moved(0.5 * dt_s, &k1));
        let k3 = slope(&self.moved(0.5 * dt_s, &k2));
        let k4 = slope(&self.moved(dt_s, &k3));
        let mean = Derivative {
            velocity_mps: mean_slope(
                k1.velocity_mps,
                k2.velocity_mps,
                k3.velocity_mps,
                k4.velocity_mps,
            ),
            acceleration_mps2: mean_slope(
                k1.acceleration_mps2,
                k2.acceleration_mps2,
                k3.acceleration_mps2,
                k4.acceleration_mps2,
            ),
            attitude: (k1.attitude + (k2.attitude + k3.attitude) * 2.0 + k4.attitude) / 6.0,
            angular_radps2: mean_slope(
                k1.angular_radps2,
                k2.angular_radps2,
                k3.angular_radps2,
                k4.angular_radps2,
            ),
            specific_force_mps2: k4.specific_force_mps2,
        };
        let moved = self.moved(dt_s, &mean);
        Self {
            attitude: UnitQuaternion::new_normalize(moved.attitude.into_inner()),
            ..moved
        }
    }

    /// The state advanced along a slope; the quaternion's length drifts.
    fn moved(&self, dt_s: f64, slope: &Derivative) -> Self {
        Self {
            position_m: self.position_m + slope.velocity_mps * dt_s,
            velocity_mps: self.velocity_mps + slope.acceleration_mps2 * dt_s,
            attitude: UnitQuaternion::new_unchecked(
                self.attitude.into_inner() + slope.attitude * dt_s,
            ),
            rates_radps: self.rates_radps + slope.angular_radps2 * dt_s,
        }
    }
}

fn mean_slope(
    k1: Vector3<f64>,
    k2: Vector3<f64>,
    k3: Vector3<f64>,
    k4: Vector3<f64>,
) -> Vector3<f64> {
    (k1 + (k2 + k3) * 2.0 + k4) / 6.0
}

/// The derivative of a state under deflections and moving air, and on the ground.
pub fn derivative(
    airframe: &Airframe,
    state: &State,
    deflections: &Deflections,
    motion: &AirMotion,
    air: &Air,
    ground: Option<&Ground>,
) -> Derivative {
    let mass = airframe.mass_kg;
    let steady = state
        .attitude
        .inverse_transform_vector(&(state.velocity_mps - motion.wind_mps));
    let through_air = steady - motion.gust_mps;
    let flow = Flow::of(&through_air);
    let relative_rates = state.rates_radps - motion.gust_rates_radps;
    let loads = aerodynamics::loads(airframe, &flow, &relative_rates, deflections, air);

    // Lift and moment depend on the rate of the angle of attack, which depends
    // on lift: one linear equation, solved here instead of lagging a step. The
    // gust is constant in body axes within a step.
    let gravity =
        state
            .attitude
            .inverse_transform_vector(&Vector3::new(0.0, 0.0, STANDARD_GRAVITY_MPS2));
    let (on_wheels, about) = ground.map_or_else(Default::default, |ground| {
        airframe.gear.loads(state, ground)
    });
    let change = (loads.force_n + on_wheels) / mass + gravity - state.rates_radps.cross(&steady);
    let symmetric = flow.symmetric_mps.max(1.0);
    let bare = (through_air.x * change.z - through_air.z * change.x) / (symmetric * symmetric);
    let alpha_rate = bare / (1.0 + loads.lift_per_alpha_rate / (mass * symmetric));
    let late_lift = loads.lift_per_alpha_rate * alpha_rate / symmetric;
    let force = loads.force_n
        + on_wheels
        + Vector3::new(late_lift * through_air.z, 0.0, -late_lift * through_air.x);
    let moment =
        loads.moment_nm + about + Vector3::new(0.0, loads.pitch_per_alpha_rate * alpha_rate, 0.0);
    let specific_force_mps2 = force / mass;
    let mut acceleration_mps2 = state.attitude.transform_vector(&specific_force_mps2);
    acceleration_mps2.z += STANDARD_GRAVITY_MPS2;
    let turn = Quaternion::from_imag(state.rates_radps * 0.5);
    Derivative {
        velocity_mps: state.velocity_mps,
        acceleration_mps2,
        attitude: state.attitude.into_inner() * turn,
        angular_radps2: angular_acceleration(airframe, &state.rates_radps, &moment),
        specific_force_mps2,
    }
}

/// Euler's equations of a body that is symmetric about its x-z plane.
fn angular_acceleration(
    airframe: &Airframe,
    rates: &Vector3<f64>,
    moment: &Vector3<f64>,
) -> Vector3<f64> {
    let inertia = &airframe.inertia;
    let momentum = Vector3::new(
        inertia.xx * rates.x - inertia.xz * rates.z,
        inertia.yy * rates.y,
        inertia.zz * rates.z - inertia.xz * rates.x,
    );
    let net = moment - rates.cross(&momentum);
    let determinant = inertia.xx * inertia.zz - inertia.xz * inertia.xz;
    Vector3::new(
        (inertia.zz * net.x + inertia.xz * net.z) / determinant,
        net.y / inertia.yy,
        (inertia.xz * net.x + inertia.xx * net.z) / determinant,
    )
}
