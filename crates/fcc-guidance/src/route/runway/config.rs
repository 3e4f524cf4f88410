//! Speeds and limits of take-off and landing.

/// Speeds and limits of take-off and landing.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RunwayConfig {
    /// Indicated airspeed at which the nose is raised, m/s.
    pub rotate_mps: f64,
    /// A take-off from the hand begins with this acceleration, m/s², along the aircraft;
    /// 0: it takes off on its wheels.
    pub launch_mps2: f64,
    /// A take-off that has not reached it within this way, m, or the
    /// [time](Self::longest_roll_s) of it, is given up.
    pub longest_roll_m: f64,
    /// Indicated airspeed of the climb, below which its pitch is reduced, m/s.
    pub climb_mps: f64,
    /// Pitch of the climb, unless the plan gives one, rad.
    pub climb_pitch_rad: f64,
    /// Indicated airspeed of the approach without wind, m/s: half of the head wind is
    /// added to it.
    pub approach_mps: f64,
    /// The glide path's angle, rad; one that the plan's approach needs may be steeper.
    pub glide_path_rad: f64,
    /// In the flare the sink rate is proportional to the height with this time
    /// constant, s, ...
    pub flare_s: f64,
    /// ... down to this one, m/s.
    pub touchdown_mps: f64,
    /// Without a range finder the height over the runway may be off by this, m.
    pub height_uncertainty_m: f64,
    /// Flaps of the take-off, 0..=1.
    pub takeoff_flaps: f64,
    /// Flaps of the landing, 0..=1.
    pub landing_flaps: f64,
    /// Whether the gear is retracted in flight; a fixed one is not written.
    pub retractable_gear: bool,
    /// Brake of the roll-out, 0..=1.
    pub brake: f64,
    /// The radius of a turn with the nose wheel fully deflected, m.
    pub steering_radius_m: f64,
    /// What the range finder reads on the wheels, m.
    pub height_on_wheels_m: f64,
    /// From this height on, m, a landing outside the following limits is given up.
    pub decision_height_m: f64,
    /// Off the centre line, m.
    pub most_cross_track_m: f64,
    /// Off the glide path, m.
    pub most_off_path_m: f64,
    /// Off the airspeed of the approach, m/s.
    pub most_off_airspeed_mps: f64,
    /// Bank, rad.
    pub most_bank_rad: f64,
}

impl RunwayConfig {
    /// Whether it is thrown.
    pub fn is_thrown(&self) -> bool {
        self.launch_mps2 > 0.0
    }

    /// How long the longest roll lasts at constant acceleration, s: without power it has no
    /// way.
    pub fn longest_roll_s(&self) -> f64 {
        2.0 * self.longest_roll_m / self.rotate_mps
    }
}

impl Default for RunwayConfig {
    /// A Cessna 172: handbook of the 172P (1981), section 4: 55 KIAS at the lift of the
    /// nose wheel, 70 to 80 KIAS in the climb, 65 to 75 KIAS in an approach without
    /// flaps; section 5: a ground roll of 890 ft at sea level without wind, and here
    /// twice that at most.
    fn default() -> Self {
        Self {
            rotate_mps: 28.294_444, // 55 kt
            launch_mps2: 0.0,
            longest_roll_m: 600.0,
            climb_mps: 38.583_333,      // 75 kt
            climb_pitch_rad: 0.139_626, // 8°
            approach_mps: 34.982_222,   // 68 kt
            glide_path_rad: 0.052_360,  // 3°
            flare_s: 4.0,
            touchdown_mps: 0.203_2,      // 40 ft/min
            height_uncertainty_m: 6.096, // 20 ft
            takeoff_flaps: 0.0,
            landing_flaps: 0.0,
            retractable_gear: false,
            brake: 0.5,
            steering_radius_m: 9.0,
            height_on_wheels_m: 1.3,
            decision_height_m: 60.96, // 200 ft
            most_cross_track_m: 15.0,
            most_off_path_m: 15.0,
            most_off_airspeed_mps: 6.173_333, // 12 kt
            most_bank_rad: 0.261_799,         // 15°
        }
    }
}
