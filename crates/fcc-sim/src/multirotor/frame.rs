//! The data of a multicopter: frame, rotors, feet, battery.

use core::f64::consts::TAU;

use nalgebra::Vector3;

use crate::atmosphere::{Air, SEA_LEVEL_DENSITY_KGPM3};

/// A rotor, whose thrust is along -z.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FrameRotor {
    /// From the centre of gravity, body axes, m.
    pub place_m: Vector3<f64>,
    /// Whether it turns clockwise, seen from above.
    pub clockwise: bool,
}

/// A multicopter's data.
#[derive(Clone, PartialEq, Debug)]
pub struct Frame {
    /// Its rotors, at most eight.
    pub rotors: Vec<FrameRotor>,
    /// kg.
    pub mass_kg: f64,
    /// About x, y and z, kg m².
    pub inertia_kgm2: Vector3<f64>,
    /// Thrust over the square of the speed, N s²/rad², at sea level.
    pub thrust_n_s2: f64,
    /// Loss of thrust by the flow along the axis, over speed and velocity, N s²/(rad m): a blade
    /// meets the air at a smaller angle (Leishman 2006, eq. 3.60).
    pub inflow_n_s2pm: f64,
    /// Drag of a rotor by the flow across, over speed and velocity, N s²/(rad m): blades
    /// flap and their drag is not the same on both sides (Mahony, Kumar and Corke 2012, eq. 9).
    pub drag_n_s2pm: f64,
    /// Torque over thrust, m.
    pub torque_ratio_m: f64,
    /// Of a rotor, kg m².
    pub rotor_inertia_kgm2: f64,
    /// Full speed at full voltage, rad/s.
    pub full_speed_radps: f64,
    /// Time constant of a motor's speed, s.
    pub motor_lag_s: f64,
    /// Area times coefficient of the body's drag, m².
    pub drag_area_m2: f64,
    /// A foot without load, from the centre of gravity: ahead, right, down, m; there are four.
    pub foot_m: Vector3<f64>,
    /// Of a full battery.
    pub battery: LithiumBattery,
    /// A rotor whose motor stops, and when, s.
    pub stops: Option<(usize, f64)>,
}

impl Frame {
    /// 1.4 kg, arms of 0.225 m, propellers of 10 inches: the size of a DJI F450, whose mass and
    /// inertia JSBSim's model has; thrust to weight 3.4. In 8 m/s it leans by 17°.
    pub fn quadrotor() -> Self {
        Self::ring(4, 0.225)
    }

    /// The same body with more rotors, each of them smaller in proportion.
    pub fn ring(count: usize, arm_m: f64) -> Self {
        let share = 4.0 / count as f64;
        let rotors = (0..count).map(|index| {
            let (sin, cos) = libm::sincos((index as f64 + 0.5) * TAU / count as f64);
            FrameRotor {
                place_m: Vector3::new(arm_m * cos, arm_m * sin, -0.02),
                clockwise: index % 2 == 1,
            }
        });
        Self {
            rotors: rotors.collect(),
            mass_kg: 1.4,
            inertia_kgm2: Vector3::new(0.019, 0.019, 0.0252),
            thrust_n_s2: share * 1.28e-5,
            inflow_n_s2pm: share * 5.0e-4,
            drag_n_s2pm: share * 1.8e-4,
            torque_ratio_m: 0.016,
            rotor_inertia_kgm2: share * 5.0e-5,
            full_speed_radps: 960.0,
            motor_lag_s: 0.035,
            drag_area_m2: 0.02,
            foot_m: Vector3::new(0.12, 0.12, 0.12),
            battery: LithiumBattery::default(),
            stops: None,
        }
    }
}

/// A lithium-polymer battery of three cells.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LithiumBattery {
    /// Of a full one, Ah.
    pub capacity_ah: f64,
    /// What is left, 0..=1.
    pub charge: f64,
    /// Drawn now, A.
    current_a: f64,
}

impl Default for LithiumBattery {
    /// 5 Ah, full.
    fn default() -> Self {
        Self {
            capacity_ah: 5.0,
            charge: 1.0,
            current_a: 0.0,
        }
    }
}

impl LithiumBattery {
    /// 4.2 V of a full cell, 3.5 V of an empty one.
    const FULL_V: f64 = 12.6;
    const EMPTY_V: f64 = 10.5;
    const RESISTANCE_OHM: f64 = 0.03;
    /// Electronics, A.
    const OTHER_A: f64 = 0.5;
    /// Of motors and controllers.
    const EFFICIENCY: f64 = 0.75;

    /// The voltage at its terminals.
    pub fn voltage_v(&self) -> f64 {
        let open_v = Self::EMPTY_V + (Self::FULL_V - Self::EMPTY_V) * self.charge;
        (open_v - Self::RESISTANCE_OHM * self.current_a).max(0.0)
    }

    /// Over that of a full one without load.
    pub(super) fn voltage_share(&self) -> f64 {
        if self.charge > 0.0 {
            self.voltage_v() / Self::FULL_V
        } else {
            0.0
        }
    }

    /// Gives the power of the shafts, W.
    pub(super) fn give(&mut self, shafts_w: f64, dt_s: f64) {
        let voltage_v = self.voltage_v().max(1.0);
        self.current_a = Self::OTHER_A + shafts_w / (Self::EFFICIENCY * voltage_v);
        let used = self.current_a * dt_s / (3_600.0 * self.capacity_ah);
        self.charge = (self.charge - used).max(0.0);
    }
}

/// Air density over that at sea level.
pub(super) fn density_share(altitude_m: f64) -> f64 {
    Air::at(altitude_m).density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3
}
