//! What is done about each contingency.

/// What is done about a contingency.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ContingencyAction {
    /// It is reported, and what is flown is flown on.
    Continue,
    /// Circle.
    Loiter,
    /// Return, and circle there.
    Return,
    /// Fly the landing sequence of the plan whose landing is nearest; return without one.
    Land,
    /// Glide to the best place that is reached, and land there.
    Glide,
}

impl ContingencyAction {
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Continue => "flying on",
            Self::Loiter => "circling",
            Self::Return => "returning",
            Self::Land => "landing",
            Self::Glide => "gliding",
        }
    }

    pub(super) const ALL: [Self; 5] = [
        Self::Continue,
        Self::Loiter,
        Self::Return,
        Self::Land,
        Self::Glide,
    ];
}

/// What is done about each contingency.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ContingencyConfig {
    /// Near the fence. To continue is to ignore its sides, but not its floor and ceiling;
    /// to land is to return.
    pub fence: ContingencyAction,
    /// How far inside of the fence the aircraft stays, m.
    pub fence_margin_m: f64,
    /// How far above its floor and below its ceiling, m.
    pub fence_height_margin_m: f64,
    /// Without a position.
    pub position: ContingencyAction,
    /// After this time, s.
    pub position_after_s: f64,
    /// When a commander has promised to be heard, and is not.
    pub commander: ContingencyAction,
    /// With a low battery, which prevents a take-off, too.
    pub battery: ContingencyAction,
    /// The battery is low below this share of its charge, 0..=1; none: not watched.
    pub battery_charge: Option<f64>,
    /// The battery is low below this voltage, V; none: not watched.
    pub battery_voltage_v: Option<f64>,
    /// After this time, s; and after it, it is low no longer.
    pub battery_after_s: f64,
    /// Without the engine.
    pub engine: ContingencyAction,
    /// The engine is out below this speed of its shaft, rad/s; none: not watched.
    pub engine_below_radps: Option<f64>,
    /// Whether, where its speed is not measured, it is out if the throttle gives no thrust.
    pub engine_by_thrust: bool,
    /// After this time, s.
    pub engine_after_s: f64,
    /// It runs again when it was above that speed for this time, s.
    pub engine_back_after_s: f64,
    /// The way through still air over the height that is lost without power at the airspeed
    /// of the best glide.
    pub glide_ratio: f64,
    /// Height to spare over a place that is glided to, m.
    pub glide_spare_m: f64,
    /// Where the ground ahead cannot be climbed over. To continue is not to watch it; to
    /// land is to return.
    pub terrain: ContingencyAction,
    /// How far above the ground the aircraft stays, m.
    pub terrain_margin_m: f64,
    /// How far ahead it is looked for, s.
    pub terrain_ahead_s: f64,
}

impl Default for ContingencyConfig {
    fn default() -> Self {
        Self {
            fence: ContingencyAction::Return,
            fence_margin_m: 30.0,
            fence_height_margin_m: 10.0,
            position: ContingencyAction::Return,
            position_after_s: 120.0,
            commander: ContingencyAction::Return,
            battery: ContingencyAction::Return,
            battery_charge: None,
            battery_voltage_v: None,
            battery_after_s: 10.0,
            engine: ContingencyAction::Glide,
            engine_below_radps: None,
            engine_by_thrust: false,
            engine_after_s: 2.0,
            engine_back_after_s: 5.0,
            // Handbook of the Cessna 172P (1981), figure 3-1.
            glide_ratio: 9.0,
            glide_spare_m: 60.96, // 200 ft
            terrain: ContingencyAction::Return,
            terrain_margin_m: 30.0,
            terrain_ahead_s: 60.0,
        }
    }
}
