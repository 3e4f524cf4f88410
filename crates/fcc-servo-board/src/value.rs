//! The values that a board has, by X-Plane's names for them.

use crate::surfaces::Surfaces;

/// The dataref of the engage switch, if no other is configured: fccd's default.
pub const ENGAGE_SWITCH: &str = "sim/cockpit2/switches/generic_lights_switch[56]";

/// The dataref of the differential pressure, Pa: the only one that X-Plane does
/// not have.
pub const DIFFERENTIAL_PRESSURE: &str = "fccd/servo_board/differential_pressure_pa";

/// m/s in a knot: 1852 m in 3600 s.
const KNOT_MPS: f32 = 1_852.0 / 3_600.0;

/// What the board measures; `None` for what it does not have, or does not know
/// at present. Then it sends no value, and the computer notices its age.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Readings {
    /// Indicated airspeed, m/s.
    pub airspeed_mps: Option<f32>,
    /// Pressure of the pitot tube minus that of the static port, Pa; may be
    /// negative. Its zero is calibrated in the computer.
    pub differential_pressure_pa: Option<f32>,
    /// Whether the engage switch is on, debounced.
    pub engage_switch: Option<bool>,
    /// Where the pilot's receiver has the servos, while nobody else does.
    pub pilot: Option<Surfaces>,
}

/// A value that a board gives or takes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Value {
    Airspeed,
    DifferentialPressure,
    EngageSwitch,
    Time,
    OverrideJoystick,
    OverrideThrottles,
    Elevator,
    Aileron,
    Rudder,
    Throttle,
    Flaps,
    LeftBrake,
    RightBrake,
    Gear,
}

impl Value {
    pub(crate) const COUNT: usize = 14;

    /// By its dataref; none if the board does not have it.
    pub(crate) fn of(path: &[u8], engage_switch: &str) -> Option<Self> {
        if path == engage_switch.as_bytes() {
            return Some(Self::EngageSwitch);
        }
        match path {
            b"sim/flightmodel/position/indicated_airspeed" => Some(Self::Airspeed),
            b"sim/network/misc/network_time_sec" => Some(Self::Time),
            b"sim/operation/override/override_joystick" => Some(Self::OverrideJoystick),
            b"sim/operation/override/override_throttles" => Some(Self::OverrideThrottles),
            b"sim/joystick/yoke_pitch_ratio" => Some(Self::Elevator),
            b"sim/joystick/yoke_roll_ratio" => Some(Self::Aileron),
            b"sim/joystick/yoke_heading_ratio" => Some(Self::Rudder),
            b"sim/flightmodel/engine/ENGN_thro_use[0]" => Some(Self::Throttle),
            b"sim/cockpit2/controls/flap_ratio" => Some(Self::Flaps),
            b"sim/cockpit2/controls/left_brake_ratio" => Some(Self::LeftBrake),
            b"sim/cockpit2/controls/right_brake_ratio" => Some(Self::RightBrake),
            b"sim/cockpit2/controls/gear_handle_down" => Some(Self::Gear),
            path if path == DIFFERENTIAL_PRESSURE.as_bytes() => Some(Self::DifferentialPressure),
            _ => None,
        }
    }
}

impl Readings {
    /// A measured value, in the unit of its dataref.
    pub(crate) fn get(&self, value: Value) -> Option<f32> {
        let value = match value {
            Value::Airspeed => self.airspeed_mps.map(|mps| mps / KNOT_MPS),
            Value::DifferentialPressure => self.differential_pressure_pa,
            Value::EngageSwitch => self.engage_switch.map(|on| f32::from(u8::from(on))),
            _ => None,
        };
        value.filter(|value| value.is_finite())
    }
}
