//! What an aircraft's sensors measure.

use super::Surfaces;
use crate::framework::{Reading, Switch};

/// What an aircraft's sensors measure, each with the time it was taken.
///
/// Control needs attitude, heading, body rates, specific force, airspeed and
/// altitude, as in the thesis; position and ground velocity are for navigation
/// where there is a source, and never needed to fly.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Measurements {
    /// Pitch and roll.
    pub attitude: Reading<Attitude>,
    /// Magnetic heading in rad, clockwise from magnetic north, 0..2π.
    pub heading_rad: Reading<f64>,
    /// Turn rates about the body axes.
    pub body_rates: Reading<BodyRates>,
    /// What accelerometers feel.
    pub specific_force: Reading<SpecificForce>,
    /// Indicated airspeed in m/s.
    pub airspeed_mps: Reading<f64>,
    /// Barometric altitude in m above the standard pressure level.
    pub altitude_m: Reading<f64>,
    /// Angle of attack in rad, positive when the air comes from below the nose.
    pub angle_of_attack_rad: Reading<f64>,
    /// Where the aircraft is; for navigation.
    pub position: Reading<Position>,
    /// How it moves over the ground; for navigation.
    pub velocity: Reading<Velocity>,
    /// Where throttle and surfaces stand, if the plant tells: for taking over
    /// without a bump.
    pub surfaces: Reading<Surfaces>,
    /// The engage switch.
    pub engage_switch: Reading<Switch>,
    /// A simulated plant's own clock and condition; never read on a real one.
    pub plant: Reading<Plant>,
}

/// Pitch and roll, rad.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Attitude {
    /// Nose above the horizon, -π/2..π/2.
    pub pitch_rad: f64,
    /// Right wing down, -π..π.
    pub roll_rad: f64,
}

/// Turn rates about the body axes, rad/s.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct BodyRates {
    /// P, about x: right wing down.
    pub roll_radps: f64,
    /// Q, about y: nose up.
    pub pitch_radps: f64,
    /// R, about z: nose right.
    pub yaw_radps: f64,
}

/// Acceleration less gravity, along the body axes, m/s²: what an accelerometer
/// reads. Level and unaccelerated, z is -9.81.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct SpecificForce {
    /// Forward.
    pub x_mps2: f64,
    /// Right.
    pub y_mps2: f64,
    /// Down.
    pub z_mps2: f64,
}

/// A place on the WGS 84 ellipsoid.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Position {
    /// North of the equator, -π/2..π/2.
    pub latitude_rad: f64,
    /// East of Greenwich, -π..π.
    pub longitude_rad: f64,
    /// Above mean sea level, m.
    pub altitude_m: f64,
}

/// Velocity over the ground, m/s.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Velocity {
    /// Towards true north.
    pub north_mps: f64,
    /// Towards east.
    pub east_mps: f64,
    /// Down.
    pub down_mps: f64,
}

/// A simulated plant's own clock and condition.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Plant {
    /// The plant's own time in s. The loop integrates with it where there is
    /// one: a simulator whose frame rate falls slows its time.
    pub time_s: f64,
    /// What the plant is doing.
    pub state: PlantState,
}

/// What a simulated plant is doing.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
#[repr(u8)]
pub enum PlantState {
    /// Time runs.
    #[default]
    Running = 0,
    /// Halted by its user: outputs are held, nothing integrates.
    Paused = 1,
    /// It speaks, but its clock stands still and it does not say paused.
    Stalled = 2,
    /// Time runs, slower than the wall clock or at a low frame rate.
    Slow = 3,
    /// Its clock jumped: it was restarted, reloaded or put somewhere else.
    Jumped = 4,
}
