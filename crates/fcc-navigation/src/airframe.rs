//! What is known of an aircraft's forces.

/// What was learned of an aircraft's forces in a flight with an airspeed sensor. With it
/// an airspeed is found without one. It holds for the sensors, their mounting, the
/// reference airspeed V₀ and about the weight of that flight.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct LearnedAirframe {
    /// Force along x over weight that thrust and drag do not explain, -0.2..=0.2.
    pub axial_offset: f64,
    /// Thrust over weight at full throttle and V₀, 0.02..=1.5.
    pub full_thrust_ratio: f64,
    /// Angle of attack without lift, as attitude and path show it, rad, -0.35..=0.35.
    pub zero_lift_angle_rad: f64,
    /// Angle of attack above that for 1 g at V₀, rad, 0.005..=0.35.
    pub one_g_angle_rad: f64,
}

/// What an airspeed filter must know of the aircraft beforehand.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct AirframePrior {
    /// The airspeed V₀ at which the ratios below hold, m/s.
    pub(super) reference_mps: f64,
    /// Thrust over weight at full throttle and V₀.
    pub(super) full_thrust_ratio: f64,
    /// What was learned in another flight.
    pub(super) learned: Option<LearnedAirframe>,
}

/// The aircraft of the default gains: 100 kt, throttle for 1 g of 3.63.
pub(super) const CESSNA_172: AirframePrior = AirframePrior {
    reference_mps: 51.444_444,
    full_thrust_ratio: 0.25,
    learned: None,
};

/// Thrust over weight at full throttle, from the throttle per g in cruise: thrust
/// is proportional to the square of the throttle, whose slope is 1 at a half.
pub(super) const FULL_THRUST_SHARE: f64 = 0.9;
