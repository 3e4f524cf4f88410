//! An aircraft's data: mass, size, derivatives, engine, with sources.

use crate::gear::Gear;
use crate::units::{
    DEGREE_RAD, FOOT_M, FOOT_POUND_NM, POUND_KG, SLUG_FT2_KGM2, STANDARD_GRAVITY_MPS2,
};

/// A rigid, symmetric, propeller-driven aircraft.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Airframe {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Moments of inertia about the body axes.
    pub inertia: Inertia,
    /// Wing area, m².
    pub wing_area_m2: f64,
    /// Wing span, m.
    pub wing_span_m: f64,
    /// Mean aerodynamic chord, m.
    pub chord_m: f64,
    /// Lift over angle of attack.
    pub lift: Lift,
    /// Drag over lift.
    pub drag: Drag,
    /// Pitching moment, pitch damping and the elevator.
    pub pitch: PitchDerivatives,
    /// Side force, roll and yaw.
    pub lateral: LateralDerivatives,
    /// Travel of the control surfaces.
    pub travel: Travel,
    /// Engine and propeller.
    pub propulsion: Propulsion,
    /// Landing gear.
    pub gear: Gear,
}

/// Moments of inertia about the body axes, kg·m².
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Inertia {
    /// About x.
    pub xx: f64,
    /// About y.
    pub yy: f64,
    /// About z.
    pub zz: f64,
    /// Product of x and z.
    pub xz: f64,
}

/// Lift over angle of attack, of the whole aircraft with neutral elevator.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lift {
    /// `C_L` at zero angle of attack.
    pub zero: f64,
    /// `C_Lα`, 1/rad.
    pub per_alpha: f64,
    /// Angle of attack of the stall, rad.
    pub stall_alpha_rad: f64,
    /// `C_L` of the stalled wing at that angle.
    pub stall: f64,
    /// Aspect ratio, for the drag of the stalled wing.
    pub aspect_ratio: f64,
}

/// The drag polar `C_D = C_D0 + K·C_L²` of the wing that is not stalled.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Drag {
    /// `C_D0`.
    pub zero: f64,
    /// `K`, 1/(π e A).
    pub induced: f64,
}

/// Derivatives of pitch and of lift other than `C_Lα`. Rates are made
/// dimensionless by `c/2V`; the elevator is positive trailing edge down.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PitchDerivatives {
    /// `C_Lα̇`.
    pub lift_per_alpha_rate: f64,
    /// `C_Lq`.
    pub lift_per_pitch_rate: f64,
    /// `C_Lδe`, 1/rad.
    pub lift_per_elevator: f64,
    /// `C_m` at zero angle of attack and neutral elevator.
    pub zero: f64,
    /// `C_mα`, 1/rad.
    pub per_alpha: f64,
    /// `C_mα̇`.
    pub per_alpha_rate: f64,
    /// `C_mq`.
    pub per_pitch_rate: f64,
    /// `C_mδe`, 1/rad.
    pub per_elevator: f64,
    /// From the centre of gravity to the horizontal tail, m.
    pub tail_arm_m: f64,
}

/// One row of lateral derivatives: of side force, roll or yaw.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LateralRow {
    /// Over sideslip, positive when the air comes from the right, 1/rad.
    pub per_beta: f64,
    /// Over roll rate, by `b/2V`.
    pub per_roll_rate: f64,
    /// Over yaw rate, by `b/2V`.
    pub per_yaw_rate: f64,
    /// Over aileron, positive rolls right, 1/rad.
    pub per_aileron: f64,
    /// Over rudder, positive trailing edge left, 1/rad.
    pub per_rudder: f64,
}

/// Derivatives of side force, rolling and yawing moment.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LateralDerivatives {
    /// `C_y`: towards the right.
    pub side: LateralRow,
    /// `C_l`: right wing down.
    pub roll: LateralRow,
    /// `C_n`: nose right.
    pub yaw: LateralRow,
}

/// Travel of the control surfaces from neutral, rad, all positive.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Travel {
    /// Elevator trailing edge up: the nose rises.
    pub elevator_up_rad: f64,
    /// Elevator trailing edge down.
    pub elevator_down_rad: f64,
    /// Mean of the two ailerons, either way.
    pub aileron_rad: f64,
    /// Rudder, either way.
    pub rudder_rad: f64,
}

/// A normally aspirated engine with a fixed-pitch propeller, after Lowry's
/// bootstrap approach (Performance of Light Aircraft, AIAA, 1999, ch. 7): the
/// propeller polar `C_T/J² = m·C_P/J² + b` is a straight line, and at full
/// throttle the torque depends on density alone, so that thrust is `2πm·M/d +
/// b·ρd²V²` at any engine speed. Throttle is a share of that torque: at 0 the
/// propeller windmills without any torque of the engine, which gives more drag
/// than a real engine at idle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Propulsion {
    /// Torque at full throttle at sea level, N·m.
    pub rated_torque_nm: f64,
    /// Share of the power that friction takes, in Gagg and Farrar's relation
    /// (1934): torque falls with density ratio as `(σ - C)/(1 - C)`.
    pub friction_share: f64,
    /// Propeller diameter, m.
    pub diameter_m: f64,
    /// Slope `m` of the propeller polar.
    pub polar_slope: f64,
    /// Intercept `b` of the propeller polar.
    pub polar_intercept: f64,
    /// Power coefficient of the propeller that does not advance, `C_P0`.
    pub power_at_rest: f64,
    /// By how much it falls with the square of the advance ratio:
    /// `C_P = C_P0 - k·J²`.
    pub power_fall: f64,
}

impl Airframe {
    /// A light high-wing single with 160 hp: a Cessna 172P in size, weight and
    /// performance, with the derivatives that are published for the 182, which
    /// has the same wing and tail.
    ///
    /// | what | source |
    /// |---|---|
    /// | area, span, chord, inertia, all derivatives, `C_L0`, `C_m0` | Roskam, *Airplane Flight Dynamics and Automatic Flight Controls* I (1995), app. B, airplane A, cruise, pp. 480-482; the same in Napolitano, *Aircraft Dynamics* (2012), app. B, Cessna 182 |
    /// | mass: 2,400 lb, the maximum | Cessna, *Pilot's Operating Handbook 172P* (1981) |
    /// | `C_D0` 0.0319, e 0.75, A 7.32 | Loftin, *Quest for Performance*, NASA SP-468 (1985), Skyhawk |
    /// | lift at the stall: 1.6 | NACA 2412: Abbott and von Doenhoff, *Theory of Wing Sections* (1959) |
    /// | arm of the horizontal tail | JSBSim's c172p, 15.7 ft |
    /// | surface travel | FAA type certificate data sheet 3A12, model 172 |
    /// | torque, diameter, propeller polar | Lowry, *Performance of Light Aircraft* (1999), Cessna 172's data plate |
    /// | power coefficient | through the middle of the static range of the engine speed of the same power and propeller, 2,280 to 2,400 rpm (Cessna 172N's handbook), and the rated 2,700 rpm at 123 kt |
    ///
    /// The 182 is heavier, so its inertia is somewhat too high here.
    pub const SKYHAWK: Self = Self {
        mass_kg: 2400.0 * POUND_KG,
        lift: Lift {
            aspect_ratio: 7.32,
            ..ROSKAM_A_LIFT
        },
        drag: Drag {
            zero: 0.0319,
            induced: 1.0 / (core::f64::consts::PI * 0.75 * 7.32),
        },
        propulsion: CESSNA_172_PROPULSION,
        ..Self::ROSKAM_A
    };

    /// Roskam's airplane A (1995, app. B) in cruise: 2,650 lb, 5,000 ft, 220.1
    /// ft/s. Drag reproduces the tabled `C_D1` 0.032 and `C_Dα` 0.121. The
    /// engine is the 182's, 230 hp at 2,400 rpm, with the 172's propeller
    /// polar, since the 182's is not available.
    pub const ROSKAM_A: Self = Self {
        mass_kg: 2650.0 * POUND_KG,
        inertia: Inertia {
            xx: 948.0 * SLUG_FT2_KGM2,
            yy: 1346.0 * SLUG_FT2_KGM2,
            zz: 1967.0 * SLUG_FT2_KGM2,
            xz: 0.0,
        },
        wing_area_m2: 174.0 * FOOT_M * FOOT_M,
        wing_span_m: 36.0 * FOOT_M,
        chord_m: 4.9 * FOOT_M,
        lift: ROSKAM_A_LIFT,
        drag: Drag {
            zero: 0.032 - 0.121 / (2.0 * 0.307 * 4.41) * 0.307 * 0.307,
            induced: 0.121 / (2.0 * 0.307 * 4.41),
        },
        pitch: PitchDerivatives {
            lift_per_alpha_rate: 1.7,
            lift_per_pitch_rate: 3.9,
            lift_per_elevator: 0.43,
            zero: 0.04,
            per_alpha: -0.613,
            per_alpha_rate: -7.27,
            per_pitch_rate: -12.4,
            per_elevator: -1.122,
            tail_arm_m: 15.7 * FOOT_M,
        },
        lateral: LateralDerivatives {
            side: LateralRow {
                per_beta: -0.393,
                per_roll_rate: -0.075,
                per_yaw_rate: 0.214,
                per_aileron: 0.0,
                per_rudder: 0.187,
            },
            roll: LateralRow {
                per_beta: -0.0923,
                per_roll_rate: -0.484,
                per_yaw_rate: 0.0798,
                per_aileron: 0.229,
                per_rudder: 0.0147,
            },
            yaw: LateralRow {
                per_beta: 0.0587,
                per_roll_rate: -0.0278,
                per_yaw_rate: -0.0937,
                per_aileron: -0.0216,
                per_rudder: -0.0645,
            },
        },
        travel: Travel {
            elevator_up_rad: 28.0 * DEGREE_RAD,
            elevator_down_rad: 23.0 * DEGREE_RAD,
            aileron_rad: 17.5 * DEGREE_RAD,
            rudder_rad: 16.0 * DEGREE_RAD,
        },
        propulsion: Propulsion {
            rated_torque_nm: 503.3 * FOOT_POUND_NM,
            ..CESSNA_172_PROPULSION
        },
        gear: Gear::CESSNA_172,
    };

    /// Weight, N.
    pub fn weight_n(&self) -> f64 {
        self.mass_kg * STANDARD_GRAVITY_MPS2
    }
}

/// 160 hp at 2,700 rpm on a propeller of 75 inches.
const CESSNA_172_PROPULSION: Propulsion = Propulsion {
    rated_torque_nm: 311.2 * FOOT_POUND_NM,
    friction_share: 0.12,
    diameter_m: 6.25 * FOOT_M,
    polar_slope: 1.70,
    polar_intercept: -0.0564,
    power_at_rest: 0.0567,
    power_fall: 0.0259,
};

const ROSKAM_A_LIFT: Lift = Lift {
    zero: 0.307,
    per_alpha: 4.41,
    stall_alpha_rad: 0.30,
    stall: 1.60,
    aspect_ratio: 36.0 * 36.0 / 174.0,
};
