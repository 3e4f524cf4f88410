//! The true state of the simulated aircraft, without sensor errors.

use fcc_core::flight::{BodyRates, SpecificForce, Velocity};

/// The true state at one moment.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
#[repr(C)]
pub struct Truth {
    /// Simulated time, s.
    pub time_s: f64,
    /// Right wing down, rad, -π..π.
    pub roll_rad: f64,
    /// Nose up, rad, -π/2..π/2.
    pub pitch_rad: f64,
    /// True heading, rad, 0..2π.
    pub heading_rad: f64,
    /// Turn rates.
    pub rates: BodyRates,
    /// Specific force at the centre of gravity.
    pub specific_force: SpecificForce,
    /// True airspeed, m/s.
    pub true_airspeed_mps: f64,
    /// Indicated airspeed, m/s.
    pub indicated_airspeed_mps: f64,
    /// Angle of attack, rad.
    pub angle_of_attack_rad: f64,
    /// Sideslip, rad, positive when the air comes from the right.
    pub sideslip_rad: f64,
    /// North of where the flight began, m.
    pub north_m: f64,
    /// East of where the flight began, m.
    pub east_m: f64,
    /// Above mean sea level, m.
    pub altitude_m: f64,
    /// Over the ground.
    pub velocity: Velocity,
    /// Throttle after the engine's lag, 0..=1.
    pub throttle: f64,
    /// Elevator deflection, rad, positive trailing edge down.
    pub elevator_rad: f64,
    /// Aileron deflection, rad, positive rolls right.
    pub aileron_rad: f64,
    /// Rudder deflection, rad, positive trailing edge left.
    pub rudder_rad: f64,
}

/// Numbers in a [`Truth`].
pub const NUMBERS: usize = 24;

impl Truth {
    /// The names of the numbers of [`to_array`](Self::to_array).
    pub const NAMES: [&str; NUMBERS] = [
        "time_s",
        "roll_rad",
        "pitch_rad",
        "heading_rad",
        "roll_rate_radps",
        "pitch_rate_radps",
        "yaw_rate_radps",
        "specific_force_x_mps2",
        "specific_force_y_mps2",
        "specific_force_z_mps2",
        "true_airspeed_mps",
        "indicated_airspeed_mps",
        "angle_of_attack_rad",
        "sideslip_rad",
        "north_m",
        "east_m",
        "altitude_m",
        "north_mps",
        "east_mps",
        "down_mps",
        "throttle",
        "elevator_rad",
        "aileron_rad",
        "rudder_rad",
    ];

    /// Every number, in the order of the fields and of [`Truth::NAMES`].
    pub fn to_array(self) -> [f64; NUMBERS] {
        [
            self.time_s,
            self.roll_rad,
            self.pitch_rad,
            self.heading_rad,
            self.rates.roll_radps,
            self.rates.pitch_radps,
            self.rates.yaw_radps,
            self.specific_force.x_mps2,
            self.specific_force.y_mps2,
            self.specific_force.z_mps2,
            self.true_airspeed_mps,
            self.indicated_airspeed_mps,
            self.angle_of_attack_rad,
            self.sideslip_rad,
            self.north_m,
            self.east_m,
            self.altitude_m,
            self.velocity.north_mps,
            self.velocity.east_mps,
            self.velocity.down_mps,
            self.throttle,
            self.elevator_rad,
            self.aileron_rad,
            self.rudder_rad,
        ]
    }

    /// The inverse of [`to_array`](Self::to_array).
    pub(crate) fn from_array(numbers: [f64; NUMBERS]) -> Self {
        let [
            time_s,
            roll_rad,
            pitch_rad,
            heading_rad,
            roll_radps,
            pitch_radps,
            yaw_radps,
            x_mps2,
            y_mps2,
            z_mps2,
            true_airspeed_mps,
            indicated_airspeed_mps,
            angle_of_attack_rad,
            sideslip_rad,
            north_m,
            east_m,
            altitude_m,
            north_mps,
            east_mps,
            down_mps,
            throttle,
            elevator_rad,
            aileron_rad,
            rudder_rad,
        ] = numbers;
        Self {
            time_s,
            roll_rad,
            pitch_rad,
            heading_rad,
            rates: BodyRates {
                roll_radps,
                pitch_radps,
                yaw_radps,
            },
            specific_force: SpecificForce {
                x_mps2,
                y_mps2,
                z_mps2,
            },
            true_airspeed_mps,
            indicated_airspeed_mps,
            angle_of_attack_rad,
            sideslip_rad,
            north_m,
            east_m,
            altitude_m,
            velocity: Velocity {
                north_mps,
                east_mps,
                down_mps,
            },
            throttle,
            elevator_rad,
            aileron_rad,
            rudder_rad,
        }
    }

    /// Interpolates between this and a later truth, with `share` in 0..=1;
    /// angles take the shorter way round.
    #[must_use]
    pub fn towards(&self, later: &Self, share: f64) -> Self {
        let (here, there) = (self.to_array(), later.to_array());
        let mut between = here;
        for (number, there) in between.iter_mut().zip(there) {
            *number += share * (there - *number);
        }
        Self {
            roll_rad: angle_between(self.roll_rad, later.roll_rad, share),
            heading_rad: turn(angle_between(self.heading_rad, later.heading_rad, share)),
            ..Self::from_array(between)
        }
    }
}

fn angle_between(from: f64, to: f64, share: f64) -> f64 {
    from + share * half_turn(to - from)
}

/// The angle in -π..=π.
pub(crate) fn half_turn(angle_rad: f64) -> f64 {
    libm::remainder(angle_rad, core::f64::consts::TAU)
}

/// The angle in 0..2π.
pub(crate) fn turn(angle_rad: f64) -> f64 {
    let around = half_turn(angle_rad);
    if around < 0.0 {
        // A tiny negative angle would round up to a full turn.
        let positive = around + core::f64::consts::TAU;
        if positive < core::f64::consts::TAU {
            positive
        } else {
            0.0
        }
    } else {
        around
    }
}
