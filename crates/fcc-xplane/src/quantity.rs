//! The quantities read from X-Plane: their datarefs, their units there, and
//! their plausible ranges.
//!
//! | dataref | field of [`Measurements`](fcc_core::flight::Measurements) |
//! |---|---|
//! | P`theta`, P`phi` | `attitude` |
//! | P`mag_psi` | `heading_rad` |
//! | P`Prad`, P`Qrad`, P`Rrad` | `body_rates` |
//! | P`local_ax/ay/az` with P`psi`, P`theta`, P`phi` | `specific_force` |
//! | P`indicated_airspeed` | `airspeed_mps` |
//! | `sim/cockpit2/gauges/indicators/altitude_ft_pilot` | `altitude_m` |
//! | P`alpha` | `angle_of_attack_rad` |
//! | P`local_vx/vy/vz` | `velocity` |
//! | the first engine's `ENGN_thro_use`, the three `yoke_*_ratio` | `surfaces` |
//! | the configured switch | `engage_switch` |
//! | `sim/time/total_flight_time_sec`, `paused`, `framerate_period` | `plant` |
//! | `onground_any`, `xplane_internal_version` | [`XPlaneStatus`](crate::XPlaneStatus) |
//! | the overrides and the controls written under them | readback of the written controls |
//!
//! with P = `sim/flightmodel/position/`. Latitude, longitude and elevation are
//! received by RPOS, since as f32 they lose about a metre.
//!
//! The altitude is what the pilot's altimeter **indicates**, so it is above the
//! standard pressure level only while the altimeter is set to 29.92 inHg, and
//! it steps when the setting is changed: do not change it while engaged.
//!
//! X-Plane's local axes (x east, y up, z south) are those of its scenery's
//! reference point: true north at the aircraft differs from them by the
//! convergence of the meridians, a fraction of a degree.

use crate::units::Unit;

const P: &str = "sim/flightmodel/position/";

/// A quantity read from X-Plane. The number of each is the index under which
/// its dataref is subscribed; it is the same in every run, so that a
/// subscription left over from a killed process is replaced and not duplicated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Quantity {
    FlightTime,
    Paused,
    FramePeriod,
    Pitch,
    Roll,
    TrueHeading,
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
}

/// Where X-Plane provides a quantity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Source {
    /// In a dataref under `sim/flightmodel/position/`.
    Position(&'static str),
    /// In this dataref.
    Dataref(&'static str),
    /// In the configured dataref of the engage switch.
    EngageSwitch,
    /// In a row of Data Output only.
    Row,
}

struct Entry(Quantity, Source, Unit, f64, f64);

use Source::{Dataref, Position, Row};

pub(crate) const OVERRIDE_JOYSTICK: &str = "sim/operation/override/override_joystick";
pub(crate) const OVERRIDE_THROTTLES: &str = "sim/operation/override/override_throttles";
pub(crate) const YOKE_PITCH: &str = "sim/joystick/yoke_pitch_ratio";
pub(crate) const YOKE_ROLL: &str = "sim/joystick/yoke_roll_ratio";
pub(crate) const YOKE_HEADING: &str = "sim/joystick/yoke_heading_ratio";

/// Quantity, source, unit there, least and greatest plausible value in that
/// unit. The ranges are wide: they exclude values that no aircraft reaches, so
/// that a corrupted number cannot enter a filter.
#[rustfmt::skip]
const TABLE: [Entry; Quantity::COUNT] = [
    Entry(Quantity::FlightTime, Dataref("sim/time/total_flight_time_sec"), Unit::Si, 0.0, 1e8),
    Entry(Quantity::Paused, Dataref("sim/time/paused"), Unit::Si, 0.0, 1.0),
    Entry(Quantity::FramePeriod, Dataref("sim/time/framerate_period"), Unit::Si, 0.0, 1e3),
    Entry(Quantity::Pitch, Position("theta"), Unit::Degrees, -90.0, 90.0),
    Entry(Quantity::Roll, Position("phi"), Unit::Degrees, -180.0, 180.0),
    Entry(Quantity::TrueHeading, Position("psi"), Unit::Degrees, -360.0, 360.0),
    Entry(Quantity::MagneticHeading, Position("mag_psi"), Unit::Degrees, -360.0, 360.0),
    Entry(Quantity::RollRate, Position("Prad"), Unit::Si, -50.0, 50.0),
    Entry(Quantity::PitchRate, Position("Qrad"), Unit::Si, -50.0, 50.0),
    Entry(Quantity::YawRate, Position("Rrad"), Unit::Si, -50.0, 50.0),
    Entry(Quantity::AccelerationEast, Position("local_ax"), Unit::Si, -1e3, 1e3),
    Entry(Quantity::AccelerationUp, Position("local_ay"), Unit::Si, -1e3, 1e3),
    Entry(Quantity::AccelerationSouth, Position("local_az"), Unit::Si, -1e3, 1e3),
    Entry(Quantity::VelocityEast, Position("local_vx"), Unit::Si, -1e4, 1e4),
    Entry(Quantity::VelocityUp, Position("local_vy"), Unit::Si, -1e4, 1e4),
    Entry(Quantity::VelocitySouth, Position("local_vz"), Unit::Si, -1e4, 1e4),
    Entry(Quantity::Airspeed, Position("indicated_airspeed"), Unit::Knots, -1e3, 1e4),
    Entry(Quantity::Altitude, Dataref("sim/cockpit2/gauges/indicators/altitude_ft_pilot"), Unit::Feet, -1e4, 1e6),
    Entry(Quantity::AngleOfAttack, Position("alpha"), Unit::Degrees, -180.0, 180.0),
    Entry(Quantity::OnGround, Dataref("sim/flightmodel/failures/onground_any"), Unit::Si, 0.0, 1.0),
    Entry(Quantity::Version, Dataref("sim/version/xplane_internal_version"), Unit::Si, 0.0, 1e6),
    Entry(Quantity::EngageSwitch, Source::EngageSwitch, Unit::Si, -1e6, 1e6),
    Entry(Quantity::OverrideJoystick, Dataref(OVERRIDE_JOYSTICK), Unit::Si, 0.0, 1.0),
    Entry(Quantity::OverrideThrottles, Dataref(OVERRIDE_THROTTLES), Unit::Si, 0.0, 1.0),
    Entry(Quantity::YokePitch, Dataref(YOKE_PITCH), Unit::Si, -1e3, 1e3),
    Entry(Quantity::YokeRoll, Dataref(YOKE_ROLL), Unit::Si, -1e3, 1e3),
    Entry(Quantity::YokeHeading, Dataref(YOKE_HEADING), Unit::Si, -1e3, 1e3),
    Entry(Quantity::Throttle, Dataref("sim/flightmodel/engine/ENGN_thro_use[0]"), Unit::Si, 0.0, 1.0),
    Entry(Quantity::LoadNormal, Row, Unit::Gravities, -100.0, 100.0),
    Entry(Quantity::LoadAxial, Row, Unit::Gravities, -100.0, 100.0),
    Entry(Quantity::LoadSide, Row, Unit::Gravities, -100.0, 100.0),
];

impl Quantity {
    pub(crate) const COUNT: usize = 31;

    /// All of them, in the order of their numbers.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        TABLE.iter().map(|entry| entry.0)
    }

    /// The quantity subscribed under an index.
    pub(crate) fn from_index(index: i32) -> Option<Self> {
        let index = usize::try_from(index).ok()?;
        TABLE.get(index).map(|entry| entry.0)
    }

    /// The index under which this is subscribed.
    pub(crate) fn index(self) -> i32 {
        i32::from(self as u8)
    }

    fn entry(self) -> Option<&'static Entry> {
        TABLE.get(self as usize)
    }

    /// Whether this comes in a row of Data Output: then it is not requested by
    /// RREF while rows are the input.
    pub(crate) fn comes_in_rows(self) -> bool {
        matches!(
            self.source(),
            Position(_) | Row | Dataref("sim/time/total_flight_time_sec")
        ) || self == Self::Altitude
    }

    fn source(self) -> Source {
        self.entry().map_or(Row, |entry| entry.1)
    }

    /// The path to subscribe; `None` if it is in no dataref. For set-up: it
    /// allocates.
    pub(crate) fn path(self, engage_switch: &str) -> Option<String> {
        match self.source() {
            Position(name) => Some(format!("{P}{name}")),
            Dataref(path) => Some(path.to_owned()),
            Source::EngageSwitch => Some(engage_switch.to_owned()),
            Row => None,
        }
    }

    /// The value in SI units and radians, if it is plausible.
    pub(crate) fn validate(self, raw: f64) -> Option<f64> {
        let Entry(_, _, unit, least, greatest) = self.entry()?;
        (*least..=*greatest).contains(&raw).then(|| unit.to_si(raw))
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
        for index in [-1, i32::MIN, 31, 1_000, i32::MAX] {
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
