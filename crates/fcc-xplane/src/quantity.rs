//! The quantities read from X-Plane: their datarefs, their units there, and
//! their plausible ranges.
//!
//! [`table`] lists them; `datarefs.md` has the same table. Latitude,
//! longitude and elevation are received by RPOS, since as f32 they lose about a
//! metre.
//!
//! The altitude is X-Plane's pressure altitude, or else what the pilot's
//! altimeter **indicates**, corrected by its setting (`pressure_altitude`).
//!
//! X-Plane's local axes (x east, y up, z south) are those of its scenery's
//! reference point, which moves with the scenery: up and north at the aircraft
//! differ from them by up to a degree, and angles from them step when the
//! reference point moves. So attitude is taken from the horizontal below the
//! aircraft where X-Plane has it; only accelerations, which are in the local
//! axes, need the angles from these.

#[cfg(test)]
#[path = "quantity/tests/document.rs"]
mod document;
mod table;

pub(crate) use table::{
    ELEVATOR_TRIM, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, YOKE_HEADING, YOKE_PITCH, YOKE_ROLL,
};
use table::{Entry, Place, TABLE};

use crate::config::PlantKind;

/// A quantity read from X-Plane. The number of each is the index under which
/// its dataref is subscribed; it is the same in every run, so that a
/// subscription left over from a killed process is replaced and not duplicated.
/// New ones are added at the end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Quantity {
    FlightTime,
    Paused,
    FramePeriod,
    Pitch,
    Roll,
    LocalHeading,
    MagneticHeading,
    RollRate,
    PitchRate,
    YawRate,
    AccelerationEast,
    AccelerationUp,
    AccelerationSouth,
    VelocityEast,
    VelocityUp,
    VelocitySouth,
    Airspeed,
    Altitude,
    AngleOfAttack,
    OnGround,
    Version,
    EngageSwitch,
    OverrideJoystick,
    OverrideThrottles,
    YokePitch,
    YokeRoll,
    YokeHeading,
    Throttle,
    LoadNormal,
    LoadAxial,
    LoadSide,
    TruePitch,
    TrueRoll,
    TrueHeading,
    Servos,
    Servos2,
    Servos3,
    ThrottleLever,
    Replay,
    PressureAltitude,
    AltimeterSetting,
    NetworkTime,
    ElevatorTrim,
    PilotPitch,
    PilotRoll,
    PilotYaw,
    DifferentialPressure,
    Height,
    EngineSpeed,
    BatteryVoltage,
}

impl Quantity {
    pub(crate) const COUNT: usize = TABLE.len();

    /// All of them, in the order of their numbers.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.quantity)
    }

    /// The quantity subscribed under an index.
    pub(crate) fn from_index(index: i32) -> Option<Self> {
        let index = usize::try_from(index).ok()?;
        TABLE.get(index).map(|entry| entry.quantity)
    }

    /// The index under which this is subscribed.
    pub(crate) fn index(self) -> i32 {
        i32::from(self as u8)
    }

    fn entry(self) -> Option<&'static Entry> {
        TABLE.get(self as usize)
    }

    /// Whether there is no substitute for it, so that its absence is reported.
    pub(crate) fn is_needed(self) -> bool {
        self.entry().is_some_and(Entry::is_needed)
    }

    /// Whether this comes in a row of Data Output: then it is not requested by
    /// RREF while rows are the input.
    pub(crate) fn comes_in_rows(self) -> bool {
        self.entry().is_some_and(|entry| entry.comes_in_rows)
    }

    /// Whether it is one of the pilot's own controls.
    pub(crate) fn is_pilots(self) -> bool {
        matches!(self, Self::PilotPitch | Self::PilotRoll | Self::PilotYaw)
    }

    /// Whether it is asked for there.
    pub(crate) fn is_asked_of(self, plant: PlantKind) -> bool {
        match plant {
            PlantKind::Simulator => !self
                .entry()
                .is_some_and(|entry| matches!(entry.place, Place::ServoBoard(_))),
            PlantKind::ServoBoard => {
                self.is_override()
                    || matches!(
                        self,
                        Self::Airspeed
                            | Self::DifferentialPressure
                            | Self::EngageSwitch
                            | Self::NetworkTime
                            | Self::YokePitch
                            | Self::YokeRoll
                            | Self::YokeHeading
                            | Self::Throttle
                    )
            }
        }
    }

    /// Whether it says who has control.
    pub(crate) fn is_override(self) -> bool {
        matches!(self, Self::OverrideJoystick | Self::OverrideThrottles)
    }

    /// The path to subscribe; `None` if it is in no dataref. For set-up: it
    /// allocates.
    pub(crate) fn path(self, engage_switch: &str) -> Option<String> {
        match self.entry()?.place {
            Place::Position(name) => Some(format!("{}{name}", table::POSITION)),
            Place::Dataref(path) | Place::ServoBoard(path) => Some(path.to_owned()),
            Place::EngageSwitch => Some(engage_switch.to_owned()),
            Place::Row => None,
        }
    }

    /// The value in SI units and radians, if it is plausible.
    pub(crate) fn validate(self, raw: f64) -> Option<f64> {
        let entry = self.entry()?;
        let [least, greatest] = entry.plausible;
        (least..=greatest)
            .contains(&raw)
            .then(|| entry.unit.to_si(raw))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_numbers() {
        for (number, quantity) in Quantity::all().enumerate() {
            assert_eq!(quantity as usize, number, "{quantity:?}");
            assert_eq!(Quantity::from_index(quantity.index()), Some(quantity));
        }
    }

    #[test]
    fn an_unknown_index_is_no_quantity() {
        for index in [-1, i32::MIN, Quantity::COUNT as i32, 1_000, i32::MAX] {
            assert_eq!(Quantity::from_index(index), None);
        }
    }

    #[test]
    fn every_path_fits_a_request() {
        for quantity in Quantity::all() {
            if let Some(path) = quantity.path(crate::engage_switch::DEFAULT) {
                crate::protocol::check_path(&path, crate::protocol::rref::PATH_BYTES).unwrap();
            }
        }
    }

    #[test]
    fn implausible_values_are_rejected() {
        assert_eq!(Quantity::Pitch.validate(91.0), None);
        assert_eq!(Quantity::Roll.validate(1e30), None);
        assert_eq!(Quantity::Airspeed.validate(f64::NAN), None);
    }
}
