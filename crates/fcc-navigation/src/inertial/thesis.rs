//! The way of the thesis (section 5.6, figures 5.9 to 5.11): gravity is what a
//! low pass leaves of the accelerometers; gravity and the magnetic field give
//! the rotation matrix, and the matrix the orientation; altitude is that of the
//! barometer; wind is neglected, and the angle of attack is the pitch.
//!
//! The two functions of Android that it calls are written after their
//! documentation (`SensorManager.getRotationMatrix`, `getOrientation`). In a
//! turn the accelerometers do not point down, and neither does this: it is the
//! reference, not the recommendation.

use libm::{asin, atan2, sqrt};

use super::{GeodeticPosition, InertialNavigation, Observation, Solution};
use fcc_core::blocks::{LowPass, limit_abs, time_constant, wrap_two_pi};
use fcc_core::flight::atmosphere::pressure_altitude_m;
use fcc_core::flight::orientation::{EulerAngles, quaternion_from_euler};
use fcc_core::framework::Time;

/// The thesis' low pass: 0.15 of the difference per sample, at 40 Hz.
const GRAVITY_SHARE: f64 = 0.15;
const GRAVITY_SAMPLE_S: f64 = 0.025;
/// Gravity times field below this gives no direction, m/s² µT: free fall, or a
/// field that points down.
const LEAST_CROSS_PRODUCT: f64 = 0.1;

/// Turns the axes of the thesis' phone, which is mounted below the aircraft with
/// its screen down and its top to the nose, into body axes: the phone's y is
/// forward, its x left, its z down. The rows of a rotation matrix.
pub const PHONE_BELOW: [[f64; 3]; 3] = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];

/// Attitude from gravity and the magnetic field, altitude from the barometer.
///
/// ```
/// use fcc_navigation::inertial::{InertialNavigation, Observation, ThesisNavigation};
/// use fcc_core::framework::Time;
///
/// let mut navigation = ThesisNavigation::new();
/// let now = Time::from_nanos(0);
/// navigation.observe(now, Observation::SpecificForce([0.0, 0.0, -9.81]));
/// navigation.observe(now, Observation::MagneticField([0.0, -20.0, 40.0]));
/// // Level, and north is to the left: the nose points east.
/// let [w, _, _, z] = navigation.step(now).quaternion;
/// assert!((w - z).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ThesisNavigation {
    axes: [LowPass; 3],
    gravity: [f64; 3],
    sampled: Time,
    field_ut: [f64; 3],
    pressure_pa: f64,
    orientation: EulerAngles,
}

impl ThesisNavigation {
    /// Without any sample yet.
    pub fn new() -> Self {
        let tau_s = time_constant(GRAVITY_SHARE, GRAVITY_SAMPLE_S);
        Self {
            axes: [LowPass::new(tau_s); 3],
            gravity: [f64::NAN; 3],
            sampled: Time::NEVER,
            field_ut: [f64::NAN; 3],
            pressure_pa: f64::NAN,
            orientation: EulerAngles {
                roll_rad: f64::NAN,
                pitch_rad: f64::NAN,
                heading_rad: f64::NAN,
            },
        }
    }

    fn low_pass(&mut self, taken: Time, force: [f64; 3]) {
        let dt_s = taken.since(self.sampled).as_secs_f64();
        let is_first = self.sampled.is_never();
        self.sampled = taken;
        for ((axis, input), gravity) in self.axes.iter_mut().zip(force).zip(&mut self.gravity) {
            if is_first {
                axis.reset(input);
            }
            *gravity = axis.step(input, dt_s);
        }
    }

    fn orient(&mut self) {
        let gravity = android_axes(self.gravity);
        if let Some(matrix) = rotation_matrix(gravity, android_axes(self.field_ut)) {
            self.orientation = orientation(matrix);
        } else if self.field_ut.iter().any(|part| part.is_nan()) {
            self.orientation = roll_and_pitch(gravity);
        }
        // Otherwise the last one stays, as where Android's function fails.
    }
}

impl Default for ThesisNavigation {
    fn default() -> Self {
        Self::new()
    }
}

impl InertialNavigation for ThesisNavigation {
    fn observe(&mut self, taken: Time, observation: Observation) {
        if !observation.is_finite() {
            return;
        }
        match observation {
            Observation::SpecificForce(force) => self.low_pass(taken, force),
            Observation::MagneticField(field) => self.field_ut = field,
            Observation::StaticPressure(pressure_pa) => self.pressure_pa = pressure_pa,
            _ => return,
        }
        self.orient();
    }

    /// The last orientation; without a magnetometer its heading is 0.
    fn step(&mut self, now: Time) -> Solution {
        Solution {
            time: now,
            quaternion: quaternion_from_euler(self.orientation),
            position: GeodeticPosition {
                altitude_m: pressure_altitude_m(self.pressure_pa),
                ..GeodeticPosition::UNKNOWN
            },
            angle_of_attack_rad: self.orientation.pitch_rad,
            ..Solution::UNKNOWN
        }
    }
}

/// Body axes (forward, right, down) as Android has them on a phone that lies on
/// its back with its top to the nose: right, forward, up.
fn android_axes([forward, right, down]: [f64; 3]) -> [f64; 3] {
    [right, forward, -down]
}

/// The rows east, north and up in the phone's axes: east is field × gravity,
/// north is gravity × east. `None` if they give no direction.
fn rotation_matrix(gravity: [f64; 3], field: [f64; 3]) -> Option<[[f64; 3]; 3]> {
    let east = cross(field, gravity);
    let length = length(east);
    if length.is_nan() || length <= LEAST_CROSS_PRODUCT {
        return None;
    }
    let east = east.map(|part| part / length);
    let up = unit(gravity);
    Some([east, cross(up, east), up])
}

/// Azimuth, pitch and roll of a rotation matrix. Android's pitch is positive with
/// the top of the phone down: the aircraft's is its negative.
fn orientation([east, north, up]: [[f64; 3]; 3]) -> EulerAngles {
    let ([_, east_of_top, _], [_, north_of_top, _]) = (east, north);
    EulerAngles {
        heading_rad: wrap_two_pi(atan2(east_of_top, north_of_top)),
        ..roll_and_pitch(up)
    }
}

/// Roll and pitch alone.
fn roll_and_pitch(up: [f64; 3]) -> EulerAngles {
    let [right, top, back] = unit(up);
    EulerAngles {
        roll_rad: atan2(-right, back),
        pitch_rad: asin(limit_abs(top, 1.0)),
        heading_rad: 0.0,
    }
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

fn length([x, y, z]: [f64; 3]) -> f64 {
    sqrt(x * x + y * y + z * z)
}

fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = length(vector);
    vector.map(|part| part / length)
}
