//! Attitude, specific force and velocity from X-Plane's local axes.
//!
//! The local axes are level and aligned with north at their origin, which is up
//! to some tens of kilometres away and moves with the scenery. Accelerations and
//! velocities are in these axes. Attitude is taken from the horizontal below the
//! aircraft where X-Plane has it: then it does not step with the origin.

use core::time::Duration;

use fcc_core::flight::{Attitude, Measurements, SpecificForce, Velocity};
use fcc_core::framework::{Reading, Time};

use crate::axial_load::AxialLoadSign;
use crate::config::DataRows;
use crate::link::SharedState;
use crate::quantity::Quantity;
use crate::specific_force::specific_force;
use crate::values::{Group, Values};

/// An X-Plane that has true angles sends them in every frame: without one for
/// this long, two frames at the lowest rate, those of the local axes are used.
const TRUE_WITHIN: Duration = Duration::from_millis(100);
/// Below this pitch, headings in the local axes and true ones can be compared.
const HEADING_UP_TO_PITCH_RAD: f64 = 1.0;

/// Computes attitude, specific force and velocity.
#[derive(Clone, Debug)]
pub(crate) struct Motion {
    /// The last accelerations (east, up, south) and the specific force computed
    /// from them.
    accelerations: [f64; 3],
    force: SpecificForce,
    /// Pitch and roll from the horizontal below the aircraft, less those from
    /// that of the local axes.
    lean: [f64; 2],
    /// When the former last arrived.
    true_attitude: Time,
    axial_load: AxialLoadSign,
}

impl Motion {
    /// `rows` where rows are the input.
    pub(crate) fn new(rows: Option<DataRows>) -> Self {
        Self {
            accelerations: [f64::NAN; 3],
            force: SpecificForce::default(),
            lean: [0.0; 2],
            true_attitude: Time::NEVER,
            axial_load: AxialLoadSign::new(rows.map(|rows| rows.axial_load)),
        }
    }

    /// Publishes what was completed since the last call.
    pub(crate) fn publish(
        &mut self,
        now: Time,
        values: &mut Values,
        into: &mut Measurements,
        link: &SharedState,
    ) {
        if let Some(([pitch_rad, roll_rad], taken)) = self.attitude(now, values) {
            let attitude = Attitude {
                pitch_rad,
                roll_rad,
            };
            into.attitude = Reading::new(attitude, taken);
        }
        if let Some(([east, up, south, heading, pitch, roll], taken)) =
            values.whole(Group::Acceleration)
        {
            self.accelerate([east, up, south], [heading, pitch, roll]);
            into.specific_force = Reading::new(self.force, taken);
        }
        if let Some((loads, taken)) = values.whole(Group::Loads) {
            let force = self.load(now, values, loads);
            link.set_axial_backwards(self.axial_load.is_backwards());
            into.specific_force = Reading::new(force, taken);
        }
        if let Some(([east, up, south], taken)) = values.whole(Group::Velocity) {
            let (sin, cos) = local_north(values, now).sin_cos();
            let velocity = Velocity {
                north_mps: -south * cos - east * sin,
                east_mps: east * cos - south * sin,
                down_mps: -up,
            };
            into.velocity = Reading::new(velocity, taken);
        }
    }

    /// Pitch and roll.
    fn attitude(&mut self, now: Time, values: &mut Values) -> Option<([f64; 2], Time)> {
        let locally = values
            .whole(Group::Attitude)
            .filter(|_| now.since(self.true_attitude) > TRUE_WITHIN);
        // Exactly level to the last bit is the answer of a version without it.
        let truly = values
            .whole(Group::TrueAttitude)
            .filter(|([pitch, roll, _, _], _)| (*pitch, *roll) != (0.0, 0.0));
        if let Some(([pitch, roll, local_pitch, local_roll], taken)) = truly {
            self.true_attitude = taken;
            self.lean = [pitch - local_pitch, roll - local_roll];
            return Some(([pitch, roll], taken));
        }
        if locally.is_some() {
            self.lean = [0.0; 2];
        }
        locally
    }

    fn accelerate(&mut self, accelerations: [f64; 3], angles: [f64; 3]) {
        // Accelerations that are repeated bit for bit belong to the instant at
        // which they first arrived. Combined with the present attitude they
        // would give a force that belongs to no instant, and a frozen one would
        // seem to change.
        if accelerations == self.accelerations {
            return;
        }
        self.accelerations = accelerations;
        let ([_, pitch, roll], [lean_pitch, lean_roll]) = (angles, self.lean);
        let attitude = Attitude {
            pitch_rad: pitch + lean_pitch,
            roll_rad: roll + lean_roll,
        };
        self.force = specific_force(accelerations, angles, attitude);
    }

    /// The specific force from load factors.
    fn load(
        &mut self,
        now: Time,
        values: &Values,
        [normal, axial, side]: [f64; 3],
    ) -> SpecificForce {
        let pitch = values.recent(Quantity::Pitch, now);
        let airspeed = values.recent(Quantity::Airspeed, now);
        self.axial_load.step(now, axial, pitch.zip(airspeed));
        SpecificForce {
            x_mps2: self.axial_load.forwards(axial),
            y_mps2: side,
            z_mps2: -normal,
        }
    }
}

/// The true direction of the local axes' north, rad clockwise from true north;
/// 0 where it is not known.
fn local_north(values: &Values, now: Time) -> f64 {
    let recent = |quantity| values.recent(quantity, now);
    let level = recent(Quantity::Pitch).filter(|pitch| pitch.abs() < HEADING_UP_TO_PITCH_RAD);
    recent(Quantity::TrueHeading)
        .zip(recent(Quantity::LocalHeading))
        .zip(level)
        .map_or(0.0, |((truly, locally), _)| truly - locally)
}
