//! The datarefs that the check reads, with a client of its own: what the daemon
//! read or wrote is not taken on trust.
//!
//! Names and units: X-Plane's `Resources/plugins/DataRefs.txt` (12.08).

/// A value read from X-Plane, in X-Plane's unit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Watched {
    FlightTime,
    Paused,
    InReplay,
    FramePeriod,
    Version,
    OnGround,
    Pitch,
    Roll,
    TrueHeading,
    RollRate,
    PitchRate,
    YawRate,
    AccelerationEast,
    AccelerationUp,
    AccelerationSouth,
    Airspeed,
    GaugeAltitude,
    Elevation,
    ClimbRate,
    AltimeterSetting,
    LoadNormal,
    LoadSide,
    OverrideJoystick,
    OverrideThrottles,
    YokePitch,
    YokeRoll,
    YokeHeading,
    Throttle,
    ServosOn,
    SpareLight,
    EngageSwitch,
}

/// The light that is written to find out whether writing takes effect.
const SPARE: &str = "sim/cockpit2/switches/generic_lights_switch[60]";
const OTHER_SPARE: &str = "sim/cockpit2/switches/generic_lights_switch[59]";

/// The name, and whether `fccd` cannot fly without it.
const TABLE: [(Watched, &str, bool); Watched::COUNT] = {
    use Watched as W;
    [
        (W::FlightTime, "sim/time/total_flight_time_sec", true),
        (W::Paused, "sim/time/paused", true),
        (W::InReplay, "sim/time/is_in_replay", false),
        (W::FramePeriod, "sim/time/framerate_period", false),
        (W::Version, "sim/version/xplane_internal_version", false),
        (W::OnGround, "sim/flightmodel/failures/onground_any", false),
        (W::Pitch, "sim/flightmodel/position/theta", true),
        (W::Roll, "sim/flightmodel/position/phi", true),
        (W::TrueHeading, "sim/flightmodel/position/psi", true),
        (W::RollRate, "sim/flightmodel/position/Prad", true),
        (W::PitchRate, "sim/flightmodel/position/Qrad", true),
        (W::YawRate, "sim/flightmodel/position/Rrad", true),
        (
            W::AccelerationEast,
            "sim/flightmodel/position/local_ax",
            true,
        ),
        (W::AccelerationUp, "sim/flightmodel/position/local_ay", true),
        (
            W::AccelerationSouth,
            "sim/flightmodel/position/local_az",
            true,
        ),
        (
            W::Airspeed,
            "sim/flightmodel/position/indicated_airspeed",
            true,
        ),
        (
            W::GaugeAltitude,
            "sim/cockpit2/gauges/indicators/altitude_ft_pilot",
            true,
        ),
        (W::Elevation, "sim/flightmodel/position/elevation", false),
        (W::ClimbRate, "sim/flightmodel/position/vh_ind_fpm", false),
        (
            W::AltimeterSetting,
            "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot",
            false,
        ),
        (W::LoadNormal, "sim/flightmodel/forces/g_nrml", false),
        (W::LoadSide, "sim/flightmodel/forces/g_side", false),
        (
            W::OverrideJoystick,
            "sim/operation/override/override_joystick",
            true,
        ),
        (
            W::OverrideThrottles,
            "sim/operation/override/override_throttles",
            true,
        ),
        (W::YokePitch, "sim/joystick/yoke_pitch_ratio", true),
        (W::YokeRoll, "sim/joystick/yoke_roll_ratio", true),
        (W::YokeHeading, "sim/joystick/yoke_heading_ratio", true),
        (W::Throttle, "sim/flightmodel/engine/ENGN_thro_use[0]", true),
        (W::ServosOn, "sim/cockpit2/autopilot/servos_on", false),
        (W::SpareLight, SPARE, false),
        (W::EngageSwitch, "", true),
    ]
};

impl Watched {
    pub(crate) const COUNT: usize = 31;

    /// All of them, in the order of their numbers.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.0)
    }

    pub(crate) const fn place(self) -> usize {
        self as usize
    }

    /// The name of the dataref; `engage_switch` is the configured one.
    pub(crate) fn path(self, engage_switch: &str) -> &str {
        match self {
            Self::EngageSwitch => engage_switch,
            Self::SpareLight if engage_switch == SPARE => OTHER_SPARE,
            _ => TABLE.get(self.place()).map_or("", |entry| entry.1),
        }
    }

    /// Whether `fccd` cannot fly without it.
    pub(crate) fn is_needed(self) -> bool {
        TABLE.get(self.place()).is_some_and(|entry| entry.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_numbers() {
        for (number, watched) in Watched::all().enumerate() {
            assert_eq!(watched.place(), number, "{watched:?}");
        }
    }

    #[test]
    fn the_light_that_is_written_is_never_the_engage_switch() {
        for switch in [SPARE, OTHER_SPARE, "sim/any"] {
            assert_ne!(Watched::SpareLight.path(switch), switch);
        }
    }
}
