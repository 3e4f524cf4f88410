//! The table of the quantities.

use super::Quantity;
use crate::units::Unit;

/// Most datarefs of the aircraft's motion are here.
pub(super) const POSITION: &str = "sim/flightmodel/position/";

pub(crate) const OVERRIDE_JOYSTICK: &str = "sim/operation/override/override_joystick";
pub(crate) const OVERRIDE_THROTTLES: &str = "sim/operation/override/override_throttles";
pub(crate) const YOKE_PITCH: &str = "sim/joystick/yoke_pitch_ratio";
pub(crate) const YOKE_ROLL: &str = "sim/joystick/yoke_roll_ratio";
pub(crate) const YOKE_HEADING: &str = "sim/joystick/yoke_heading_ratio";
pub(crate) const ELEVATOR_TRIM: &str = "sim/flightmodel/controls/elv_trim";

/// Where X-Plane provides a quantity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Place {
    /// In a dataref under [`POSITION`].
    Position(&'static str),
    /// In this dataref.
    Dataref(&'static str),
    /// In the configured dataref of the engage switch.
    EngageSwitch,
    /// In a row of Data Output only.
    Row,
    /// X-Plane does not have it: in this dataref of a servo board.
    ServoBoard(&'static str),
}

/// What happens if a quantity never arrives, as text for users.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum IfMissing {
    /// Its absence is reported, and has this consequence.
    Reported(&'static str),
    /// Older versions do not have it, and this is done instead.
    Instead(&'static str),
}

/// The sources of a row: of its name, type, unit and whether it can be written,
/// and of its sign.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum StatedBy {
    /// X-Plane's own list of datarefs.
    List,
    /// The same; the sign is that which `ArduPilot` uses.
    ListAndArduPilot,
    /// The same; that gravity is not in it: issue 1981 of `SimHub`.
    ListAndSimHub,
}

pub(super) struct Entry {
    pub(super) quantity: Quantity,
    pub(super) place: Place,
    pub(super) unit: Unit,
    /// The least and the greatest plausible value in that unit. The ranges are
    /// wide: they exclude values that no aircraft reaches, so that a corrupted
    /// number cannot enter a filter.
    pub(super) plausible: [f64; 2],
    /// What it is, and what a positive value means.
    pub(super) meaning: &'static str,
    /// The oldest list of X-Plane's datarefs that has it.
    pub(super) since: &'static str,
    pub(super) stated_by: StatedBy,
    /// Whether it is also written.
    pub(super) is_written: bool,
    /// Whether a row of Data Output has it, too.
    pub(super) comes_in_rows: bool,
    pub(super) if_missing: IfMissing,
}

impl Entry {
    const fn new(quantity: Quantity, place: Place, unit: Unit, plausible: [f64; 2]) -> Self {
        Self {
            quantity,
            place,
            unit,
            plausible,
            meaning: "",
            since: "9.55",
            stated_by: StatedBy::List,
            is_written: false,
            comes_in_rows: false,
            if_missing: IfMissing::Reported(""),
        }
    }

    const fn is(mut self, meaning: &'static str) -> Self {
        self.meaning = meaning;
        self
    }

    const fn since(mut self, version: &'static str) -> Self {
        self.since = version;
        self
    }

    const fn by(mut self, stated_by: StatedBy) -> Self {
        self.stated_by = stated_by;
        self
    }

    const fn written(mut self) -> Self {
        self.is_written = true;
        self
    }

    const fn in_rows(mut self) -> Self {
        self.comes_in_rows = true;
        self
    }

    /// Its absence is reported, with this consequence.
    const fn or_else(mut self, consequence: &'static str) -> Self {
        self.if_missing = IfMissing::Reported(consequence);
        self
    }

    /// It is optional: this is done instead.
    const fn instead(mut self, substitute: &'static str) -> Self {
        self.if_missing = IfMissing::Instead(substitute);
        self
    }

    pub(super) const fn is_needed(&self) -> bool {
        matches!(self.if_missing, IfMissing::Reported(_))
    }
}

use Place::{Dataref, Position, Row, ServoBoard};
use StatedBy::{ListAndArduPilot, ListAndSimHub};

const NO_ATTITUDE: &str = "no attitude: not engaged";
const NO_RATES: &str = "no body rates: not engaged";
const NO_ACCELERATION: &str = "no acceleration: not engaged";
const NO_VELOCITY: &str = "no velocity over the ground, so the airspeed is not compared with it";
const UNCONFIRMED: &str = "that the controls take effect is not confirmed";
const NOT_NOTICED: &str = "not noticed";
const NO_TAKEOVER: &str = "the stick does not take over";
const NO_SURFACES: &str = "engages from trim throttle and centred surfaces";

/// All quantities, in the order of their numbers.
#[rustfmt::skip]
pub(super) const TABLE: &[Entry] = &[
    Entry::new(Quantity::FlightTime, Dataref("sim/time/total_flight_time_sec"), Unit::Seconds, [0.0, 1e8]).in_rows()
        .is("since the flight was loaded; stands still in a pause").or_else("our time is used instead"),
    Entry::new(Quantity::Paused, Dataref("sim/time/paused"), Unit::Flag, [0.0, 1.0])
        .is("paused by its user").or_else("a pause counts as a stopped clock"),
    Entry::new(Quantity::FramePeriod, Dataref("sim/time/framerate_period"), Unit::Seconds, [0.0, 1e3]).since("10.41")
        .is("of a frame, smoothed").or_else("a slow simulator is known from its clock only"),
    Entry::new(Quantity::Pitch, Position("theta"), Unit::Degrees, [-90.0, 90.0]).in_rows()
        .is("nose up, from the horizontal of the local axes").or_else(NO_ATTITUDE),
    Entry::new(Quantity::Roll, Position("phi"), Unit::Degrees, [-180.0, 180.0]).in_rows()
        .is("right wing down, about the local axes").or_else(NO_ATTITUDE),
    Entry::new(Quantity::LocalHeading, Position("psi"), Unit::Degrees, [-360.0, 360.0]).in_rows()
        .is("clockwise from the local axes' north").or_else(NO_ACCELERATION),
    Entry::new(Quantity::MagneticHeading, Position("mag_psi"), Unit::Degrees, [-360.0, 360.0]).in_rows().since("10.41")
        .is("clockwise from magnetic north").or_else("no heading: not engaged"),
    Entry::new(Quantity::RollRate, Position("Prad"), Unit::RadiansPerSecond, [-50.0, 50.0]).in_rows().by(ListAndArduPilot)
        .is("right wing down").or_else(NO_RATES),
    Entry::new(Quantity::PitchRate, Position("Qrad"), Unit::RadiansPerSecond, [-50.0, 50.0]).in_rows().by(ListAndArduPilot)
        .is("nose up").or_else(NO_RATES),
    Entry::new(Quantity::YawRate, Position("Rrad"), Unit::RadiansPerSecond, [-50.0, 50.0]).in_rows().by(ListAndArduPilot)
        .is("nose right").or_else(NO_RATES),
    Entry::new(Quantity::AccelerationEast, Position("local_ax"), Unit::MetresPerSecondSquared, [-1e3, 1e3]).in_rows().by(ListAndSimHub)
        .is("east, of the local axes").or_else(NO_ACCELERATION),
    Entry::new(Quantity::AccelerationUp, Position("local_ay"), Unit::MetresPerSecondSquared, [-1e3, 1e3]).in_rows().by(ListAndSimHub)
        .is("up, of the local axes; without gravity, so 0 in level flight").or_else(NO_ACCELERATION),
    Entry::new(Quantity::AccelerationSouth, Position("local_az"), Unit::MetresPerSecondSquared, [-1e3, 1e3]).in_rows().by(ListAndSimHub)
        .is("south, of the local axes").or_else(NO_ACCELERATION),
    Entry::new(Quantity::VelocityEast, Position("local_vx"), Unit::MetresPerSecond, [-1e4, 1e4]).in_rows()
        .is("east, of the local axes").or_else(NO_VELOCITY),
    Entry::new(Quantity::VelocityUp, Position("local_vy"), Unit::MetresPerSecond, [-1e4, 1e4]).in_rows()
        .is("up, of the local axes").or_else(NO_VELOCITY),
    Entry::new(Quantity::VelocitySouth, Position("local_vz"), Unit::MetresPerSecond, [-1e4, 1e4]).in_rows()
        .is("south, of the local axes").or_else(NO_VELOCITY),
    Entry::new(Quantity::Airspeed, Position("indicated_airspeed"), Unit::Knots, [-1e3, 1e4]).in_rows()
        .is("indicated").or_else("no airspeed: not engaged"),
    Entry::new(Quantity::Altitude, Dataref("sim/cockpit2/gauges/indicators/altitude_ft_pilot"), Unit::Feet, [-1e4, 1e6]).in_rows()
        .is("indicated by the pilot's altimeter, so it follows its knob; where X-Plane has no pressure altitude, it is corrected by the setting").or_else("no altitude, where X-Plane has no pressure altitude: not engaged"),
    Entry::new(Quantity::AngleOfAttack, Position("alpha"), Unit::Degrees, [-180.0, 180.0]).in_rows()
        .is("air from below the nose").or_else("no angle of attack, which control does not need"),
    Entry::new(Quantity::OnGround, Dataref("sim/flightmodel/failures/onground_any"), Unit::Flag, [0.0, 1.0])
        .is("a wheel is on the ground").or_else("no take-off, and a landing does not brake"),
    Entry::new(Quantity::Version, Dataref("sim/version/xplane_internal_version"), Unit::Number, [0.0, 1e6]).since("10.41")
        .is("115501 for 11.55r01").or_else("not shown"),
    Entry::new(Quantity::EngageSwitch, Place::EngageSwitch, Unit::Flag, [-1e6, 1e6])
        .is("on from 0.75, off below 0.25, unchanged in between").or_else("engage by a command"),
    Entry::new(Quantity::OverrideJoystick, Dataref(OVERRIDE_JOYSTICK), Unit::Flag, [0.0, 1.0]).written()
        .is("the yoke's datarefs are written by a program; joystick, keys, mouse and auto-coordination have no effect").or_else(UNCONFIRMED),
    Entry::new(Quantity::OverrideThrottles, Dataref(OVERRIDE_THROTTLES), Unit::Flag, [0.0, 1.0]).written()
        .is("the throttles are written by a program").or_else(UNCONFIRMED),
    Entry::new(Quantity::YokePitch, Dataref(YOKE_PITCH), Unit::Ratio, [-1e3, 1e3]).written()
        .is("-1 to 1, nose up").or_else(NO_SURFACES),
    Entry::new(Quantity::YokeRoll, Dataref(YOKE_ROLL), Unit::Ratio, [-1e3, 1e3]).written()
        .is("-1 to 1, right").or_else(NO_SURFACES),
    Entry::new(Quantity::YokeHeading, Dataref(YOKE_HEADING), Unit::Ratio, [-1e3, 1e3]).written()
        .is("-1 to 1, nose right").or_else(NO_SURFACES),
    Entry::new(Quantity::Throttle, Dataref("sim/flightmodel/engine/ENGN_thro_use[0]"), Unit::Ratio, [-2.0, 2.0]).written()
        .is("0 idle, 1 full, negative in reverse; 0 to 1 is written, for each engine").or_else(NO_SURFACES),
    Entry::new(Quantity::LoadNormal, Row, Unit::Gravities, [-100.0, 100.0]).in_rows(),
    Entry::new(Quantity::LoadAxial, Row, Unit::Gravities, [-100.0, 100.0]).in_rows(),
    Entry::new(Quantity::LoadSide, Row, Unit::Gravities, [-100.0, 100.0]).in_rows(),
    Entry::new(Quantity::TruePitch, Position("true_theta"), Unit::Degrees, [-90.0, 90.0]).in_rows().since("11.5")
        .is("nose up, from the horizontal below the aircraft").instead("`theta`, which may step when the local axes move"),
    Entry::new(Quantity::TrueRoll, Position("true_phi"), Unit::Degrees, [-180.0, 180.0]).in_rows().since("11.5")
        .is("right wing down, from the horizontal below the aircraft").instead("`phi`"),
    Entry::new(Quantity::TrueHeading, Position("true_psi"), Unit::Degrees, [-360.0, 360.0]).in_rows().since("11.5")
        .is("clockwise from true north").instead("the local axes' north counts as true north"),
    Entry::new(Quantity::Servos, Dataref("sim/cockpit2/autopilot/servos_on"), Unit::Flag, [0.0, 1.0])
        .is("X-Plane's autopilot moves the controls").instead(NOT_NOTICED),
    Entry::new(Quantity::Servos2, Dataref("sim/cockpit2/autopilot/servos2_on"), Unit::Flag, [0.0, 1.0]).since("11.5")
        .is("its second autopilot does").instead(NOT_NOTICED),
    Entry::new(Quantity::Servos3, Dataref("sim/cockpit2/autopilot/servos3_on"), Unit::Flag, [0.0, 1.0]).since("11.5")
        .is("its third autopilot does").instead(NOT_NOTICED),
    Entry::new(Quantity::ThrottleLever, Dataref("sim/cockpit2/engine/actuators/throttle_ratio[0]"), Unit::Ratio, [-2.0, 2.0])
        .is("0 idle, 1 full").instead("where the lever is is not said at a release"),
    Entry::new(Quantity::Replay, Dataref("sim/time/is_in_replay"), Unit::Flag, [0.0, 1.0])
        .is("shows a recorded flight; nothing is written then").instead(NOT_NOTICED),
    Entry::new(Quantity::PressureAltitude, Dataref("sim/flightmodel2/position/pressure_altitude"), Unit::Feet, [-1e4, 1e6]).since("12")
        .is("in the standard atmosphere; does not follow the pilot's knob").instead("the pilot's altimeter, corrected by its setting"),
    Entry::new(Quantity::AltimeterSetting, Dataref("sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot"), Unit::InchesOfMercury, [22.0, 33.0])
        .is("the setting of the pilot's altimeter").or_else("no altitude, where X-Plane has no pressure altitude: not engaged"),
    Entry::new(Quantity::NetworkTime, Dataref("sim/network/misc/network_time_sec"), Unit::Seconds, [0.0, 1e8])
        .is("runs on in a pause").instead("what a network delivers late, but evenly, is not noticed"),
    Entry::new(Quantity::ElevatorTrim, Dataref(ELEVATOR_TRIM), Unit::Ratio, [-10.0, 10.0]).written()
        .is("-1 to 1, nose up").instead("the elevator's trim is left as it is"),
    Entry::new(Quantity::PilotPitch, Dataref("sim/joystick/joy_mapped_axis_value[1]"), Unit::Ratio, [-1.1, 1.1]).since("11.5")
        .is("where the pilot holds the stick, nose up; asked for only with `engage.stick_takeover`").or_else(NO_TAKEOVER),
    Entry::new(Quantity::PilotRoll, Dataref("sim/joystick/joy_mapped_axis_value[2]"), Unit::Ratio, [-1.1, 1.1]).since("11.5")
        .is("the same, right").or_else(NO_TAKEOVER),
    Entry::new(Quantity::PilotYaw, Dataref("sim/joystick/joy_mapped_axis_value[3]"), Unit::Ratio, [-1.1, 1.1]).since("11.5")
        .is("the same, right pedal").or_else(NO_TAKEOVER),
    Entry::new(Quantity::DifferentialPressure, ServoBoard("fccd/servo_board/differential_pressure_pa"), Unit::Pascals, [-2e4, 2e4])
        .is("of the pitot tube").instead("the airspeed that the board computes"),
    Entry::new(Quantity::Height, Position("y_agl"), Unit::Metres, [-1e3, 1e6])
        .is("above the ground; taken for a range finder's").instead("a landing is flown by the runway's elevation"),
    Entry::new(Quantity::EngineSpeed, Dataref("sim/cockpit2/engine/indicators/engine_speed_rpm[0]"), Unit::RevolutionsPerMinute, [-1e3, 1e6])
        .is("of the first engine").instead("not shown"),
    Entry::new(Quantity::BatteryVoltage, Dataref("sim/cockpit2/electrical/battery_voltage_actual_volts[0]"), Unit::Volts, [0.0, 1e3]).since("10.41")
        .is("of the first battery").instead("not shown"),
];
