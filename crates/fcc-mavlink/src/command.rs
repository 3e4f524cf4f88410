//! Commands: one table of `MAV_CMD`, with the parameters that are carried out.
//!
//! Numbers and parameters: MAVLink's `common.xml`. A parameter that is not in a row's list has
//! to be 0 or unset, or the command is denied.

use fcc_telemetry::Command;
use mavlink::dialects::common::MavResult;

use crate::frame::Fields;
use crate::message::home_altitude_m;
use crate::mission::Missions;
use crate::mode::{Row as ModeRow, by_custom_mode, by_standard_mode};
use crate::vehicle::{Mode, VehicleState};

type Code = MavResult;

/// Of `MAV_CMD_COMPONENT_ARM_DISARM`: whatever is in the way.
const FORCE: f64 = 21_196.0;
/// Of `MAV_CMD_DO_REPOSITION`: change the mode. Without, nothing would change.
const CHANGE_MODE: f64 = 1.0;

/// A command as it was sent.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Received {
    pub(crate) number: u16,
    /// From 1; NaN is unset. Places in degrees.
    parameters: [f64; 7],
    /// `MAV_FRAME` of a place; none in `COMMAND_LONG`.
    frame: Option<u8>,
    /// How often it was sent before.
    pub(crate) confirmation: u8,
    /// Its bytes, without what differs when it is sent again.
    pub(crate) bytes: [u8; 36],
}

impl Received {
    /// From the payload of `COMMAND_LONG`.
    pub(crate) fn long(fields: &Fields) -> Self {
        Self {
            number: fields.u16(28),
            parameters: [0, 4, 8, 12, 16, 20, 24].map(|at| fields.f32(at).into()),
            frame: None,
            confirmation: fields.u8(32),
            bytes: same_bytes(fields, 32),
        }
    }

    /// From the payload of `COMMAND_INT`.
    pub(crate) fn int(fields: &Fields) -> Self {
        let [a, b, c, d] = [0, 4, 8, 12].map(|at| f64::from(fields.f32(at)));
        let [x, y] = [16, 20].map(|at| match fields.i32(at) {
            i32::MAX => f64::NAN,
            number => f64::from(number) / 1e7,
        });
        Self {
            number: fields.u16(28),
            parameters: [a, b, c, d, x, y, fields.f32(24).into()],
            frame: Some(fields.u8(32)),
            confirmation: 0,
            bytes: same_bytes(fields, 35),
        }
    }

    /// A command that is no message of its own: its first two parameters.
    pub(crate) fn of(number: u16, [a, b]: [f64; 2]) -> Self {
        let unset = f64::NAN;
        Self {
            number,
            parameters: [a, b, unset, unset, unset, unset, unset],
            frame: None,
            confirmation: 0,
            bytes: [0; 36],
        }
    }

    /// A parameter from 1; none if it is unset.
    fn given(&self, number: usize) -> Option<f64> {
        let value = self.parameters.get(number.wrapping_sub(1)).copied();
        value.filter(|value| !value.is_nan())
    }

    /// The same, where 0 is unset, too.
    fn not_zero(&self, number: usize) -> Option<f64> {
        self.given(number).filter(|value| *value != 0.0)
    }

    /// A whole number that is not negative; unset counts as 0.
    pub(crate) fn whole(&self, number: usize) -> Option<u32> {
        let value = self.given(number).unwrap_or(0.0);
        let is_whole = value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value);
        is_whole.then_some(value as u32)
    }

    /// An altitude above mean sea level, m, of parameter 7.
    fn altitude_m(&self, state: &VehicleState) -> Result<Option<f64>, Refusal> {
        let above_m = match self.frame {
            None | Some(0 | 5) => 0.0,
            Some(3 | 6) => home_altitude_m(state),
            Some(frame) => {
                let why = format!("frame {frame}: give 0 (above sea level) or 3 (above home)");
                return Err((Code::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME, why));
            }
        };
        Ok(self.given(7).map(|altitude_m| altitude_m + above_m))
    }
}

/// The first bytes of a payload, and how many, which tells both encodings apart.
fn same_bytes(fields: &Fields, count: u8) -> [u8; 36] {
    let mut bytes: [u8; 36] = fields.bytes(0);
    for byte in bytes.iter_mut().skip(count.into()) {
        *byte = 0;
    }
    bytes[35] = count;
    bytes
}

/// Why a command is not carried out: code and words.
pub(crate) type Refusal = (MavResult, String);

/// What a command comes to.
#[derive(Debug)]
pub(crate) enum Todo {
    /// To be done by the vehicle, one after the other.
    Vehicle(Vec<Command>),
    /// Nothing is to be done: it is so already.
    Nothing,
    /// By the protocol itself.
    Protocol(OfProtocol),
}

/// What the protocol does itself.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum OfProtocol {
    /// Send a message once; one of several.
    Message(u32, u8),
    /// Send a message every so often, µs: -1 never, 0 the usual.
    Interval(u32, i32),
    /// Say how often a message is sent.
    TellInterval(u32),
    /// The item that is flown when control is taken, from 0.
    Start(u16),
    /// The mode that is shown in standby.
    Choose(Mode),
    /// Take or give back control: whether others may take it over.
    Operator { takes: bool, takeover: bool },
    /// Only `HIGH_LATENCY2` on this link.
    HighLatency(bool),
}

/// What a command is judged by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Situation<'a> {
    pub(crate) state: &'a VehicleState,
    pub(crate) missions: &'a Missions,
}

type Judged = Result<Todo, Refusal>;

/// A row of the table.
#[derive(Debug)]
pub(crate) struct Row {
    pub(crate) number: u16,
    /// The parameters that are carried out, from 1.
    parameters: &'static [usize],
    /// Whether only who is in control may send it.
    pub(crate) controls: bool,
    judge: fn(&Received, &Situation<'_>) -> Judged,
}

const fn row(
    number: u16,
    parameters: &'static [usize],
    judge: fn(&Received, &Situation<'_>) -> Judged,
) -> Row {
    Row {
        number,
        parameters,
        controls: true,
        judge,
    }
}

/// A row of what everybody may ask.
const fn ask(
    number: u16,
    parameters: &'static [usize],
    judge: fn(&Received, &Situation<'_>) -> Judged,
) -> Row {
    Row {
        number,
        parameters,
        controls: false,
        judge,
    }
}

/// Every command that is carried out. All others are unsupported.
#[rustfmt::skip]
static COMMANDS: [Row; 25] = [
    row(17, &[], |_, s| in_flight(s, set("pause", 1.0))),                        // NAV_LOITER_UNLIM
    row(20, &[], |_, s| in_flight(s, set("return_home", 1.0))),                  // NAV_RETURN_TO_LAUNCH
    row(21, &[], |_, s| in_flight(s, set("land", 1.0))),                         // NAV_LAND
    row(22, &[], |_, s| take_off(s)),                                            // NAV_TAKEOFF
    row(176, &[1, 2, 3], set_mode),                                              // DO_SET_MODE
    row(178, &[1, 2, 3, 4], change_speed),                                       // DO_CHANGE_SPEED
    row(186, &[1, 2], change_altitude),                                          // DO_CHANGE_ALTITUDE
    row(189, &[], |_, s| in_flight(s, set("land", 1.0))),                        // DO_LAND_START
    row(191, &[], |_, s| in_flight(s, set("go_around", 1.0))),                   // DO_GO_AROUND
    row(192, &[1, 2, 3, 4, 5, 6, 7], reposition),                                // DO_REPOSITION
    row(193, &[1], pause_continue),                                              // DO_PAUSE_CONTINUE
    row(224, &[1, 2], set_current),                                              // DO_SET_MISSION_CURRENT
    row(262, &[1], set_standard_mode),                                           // DO_SET_STANDARD_MODE
    row(300, &[1, 2], start_mission),                                            // MISSION_START
    row(400, &[1, 2], arm_disarm),                                               // COMPONENT_ARM_DISARM
    row(43_000, &[1, 2], guided_speed),                                          // GUIDED_CHANGE_SPEED
    row(43_001, &[7], guided_altitude),                                          // GUIDED_CHANGE_ALTITUDE
    row(43_002, &[1, 2], guided_heading),                                        // GUIDED_CHANGE_HEADING
    ask(410, &[], |_, _| Ok(Todo::message(242, 0))),                                       // GET_HOME_POSITION
    ask(510, &[1], |c, _| Ok(Todo::Protocol(OfProtocol::TellInterval(number(c, 1)?)))),    // GET_MESSAGE_INTERVAL
    ask(511, &[1, 2, 7], set_interval),                                          // SET_MESSAGE_INTERVAL
    ask(512, &[1, 2, 7], |c, _| Ok(Todo::message(number(c, 1)?, number(c, 2)? as u8))),    // REQUEST_MESSAGE
    ask(520, &[1], |_, _| Ok(Todo::message(148, 0))),                                      // REQUEST_AUTOPILOT_CAPABILITIES
    ask(2_600, &[1], high_latency),                                              // CONTROL_HIGH_LATENCY
    ask(32_100, &[1, 2, 3, 4], operator),                                        // REQUEST_OPERATOR_CONTROL
];

/// The row of a command.
pub(crate) fn row_of(number: u16) -> Option<&'static Row> {
    COMMANDS.iter().find(|row| row.number == number)
}

impl Row {
    /// What the command comes to.
    pub(crate) fn judge(&self, command: &Received, situation: &Situation<'_>) -> Judged {
        let not_carried_out = (1..=7)
            .filter(|number| !self.parameters.contains(number))
            .find_map(|number| Some((number, command.not_zero(number)?)));
        if let Some((number, given)) = not_carried_out {
            return denied(format!(
                "command {}: parameter {number}, {given}, is not carried out: give 0 or NaN",
                self.number
            ));
        }
        (self.judge)(command, situation)
    }
}

fn denied<T>(why: impl Into<String>) -> Result<T, Refusal> {
    Err((Code::MAV_RESULT_DENIED, why.into()))
}

fn not_now<T>(why: impl Into<String>) -> Result<T, Refusal> {
    Err((Code::MAV_RESULT_TEMPORARILY_REJECTED, why.into()))
}

fn set(name: &str, value: f64) -> Command {
    Command::set([(name, value)])
}

impl Todo {
    fn one(command: Command) -> Self {
        Self::Vehicle(vec![command])
    }

    const fn message(number: u32, index: u8) -> Self {
        Self::Protocol(OfProtocol::Message(number, index))
    }
}

/// A parameter that is a whole number.
fn number(command: &Received, parameter: usize) -> Result<u32, Refusal> {
    let why = || {
        let what = format!("parameter {parameter}: give a whole number");
        (Code::MAV_RESULT_DENIED, what)
    };
    command.whole(parameter).ok_or_else(why)
}

const LANDED: &str = "the aircraft has landed: disarm first";
const NOT_ENGAGED: &str = "control is not taken: arm first";

fn in_flight(situation: &Situation<'_>, command: Command) -> Judged {
    if situation.state.flight.is_engaged {
        return Ok(Todo::one(command));
    }
    if situation.state.flight.is_airborne {
        let why = "the pilot is in control: arm first";
        return Err((Code::MAV_RESULT_NOT_IN_CONTROL, why.to_owned()));
    }
    not_now(NOT_ENGAGED)
}

/// Takes control: the mission is flown then, from its first item or the chosen one.
fn engage(situation: &Situation<'_>) -> Judged {
    let missions = situation.missions;
    if missions.total() == 0 {
        return denied(missions.why_none());
    }
    let start = missions.current(situation.state);
    let item = (start > 0).then(|| set("plan_item", f64::from(start + 1)));
    Ok(Todo::Vehicle(
        [Command::Engage].into_iter().chain(item).collect(),
    ))
}

fn take_off(situation: &Situation<'_>) -> Judged {
    match situation.state.flight {
        flight if flight.is_airborne => not_now("the aircraft is in the air"),
        _ if situation.state.has_landed() => not_now(LANDED),
        flight if flight.is_engaged => Ok(Todo::Nothing),
        // The mission says where to and how high.
        _ => engage(situation),
    }
}

fn arm_disarm(command: &Received, situation: &Situation<'_>) -> Judged {
    let flight = &situation.state.flight;
    let is_forced = match command.not_zero(2) {
        None => false,
        Some(FORCE) => true,
        Some(other) => return denied(format!("parameter 2, {other}: give 0 or {FORCE}")),
    };
    match command.given(1) {
        Some(1.0) if flight.is_engaged => Ok(Todo::Nothing),
        Some(1.0) if is_forced => denied("what inhibits engaging cannot be overruled"),
        Some(1.0) => engage(situation),
        Some(0.0) if !flight.is_engaged => Ok(Todo::Nothing),
        Some(0.0) if flight.is_airborne && !is_forced => {
            denied("in the air: nothing would hold the aircraft; land, or force it (21196)")
        }
        Some(0.0) => Ok(Todo::one(Command::Disengage)),
        _ => denied("parameter 1: give 1 (arm) or 0 (disarm)"),
    }
}

fn start_mission(command: &Received, situation: &Situation<'_>) -> Judged {
    let (state, missions) = (situation.state, situation.missions);
    let total = missions.total();
    let last = command.not_zero(2);
    if last.is_some_and(|last| last != f64::from(total) - 1.0) {
        return denied("parameter 2: the mission is flown to its end: give 0 or its last item");
    }
    let first = command.not_zero(1).filter(|first| *first != -1.0);
    if first.is_some_and(|first| first.fract() != 0.0 || !(0.0..f64::from(total)).contains(&first))
    {
        return denied(format!(
            "parameter 1: the mission has {total} items, from 0"
        ));
    }
    if state.has_landed() {
        return not_now(LANDED);
    }
    if !state.flight.is_engaged {
        let Some(first) = first else {
            return engage(situation);
        };
        let item = set("plan_item", first + 1.0);
        return Ok(Todo::Vehicle(vec![Command::Engage, item]));
    }
    match first {
        None if state.flies_mission() => Ok(Todo::Nothing),
        None => Ok(Todo::one(set("plan_item", 0.0))),
        Some(first) => Ok(Todo::one(set("plan_item", first + 1.0))),
    }
}

/// The results are those of the message's definition.
fn set_current(command: &Received, situation: &Situation<'_>) -> Judged {
    let (state, missions) = (situation.state, situation.missions);
    let total = missions.total();
    let failed = |why: String| Err((Code::MAV_RESULT_FAILED, why));
    if total == 0 {
        return failed(missions.why_none().to_owned());
    }
    let resets = match command.given(2) {
        None | Some(0.0) => false,
        Some(1.0) => true,
        Some(other) => return denied(format!("parameter 2, {other}: give 0 or 1")),
    };
    let item = match command.given(1) {
        Some(-1.0) if !resets || !state.flight.is_engaged => return Ok(Todo::Nothing),
        Some(-1.0) => missions.current(state),
        Some(item) if item < 0.0 || item.fract() != 0.0 => {
            return denied(format!("parameter 1, {item}: give an item from 0"));
        }
        Some(item) if item >= f64::from(total) => {
            return failed(format!("item {item}: the mission has {total}, from 0"));
        }
        Some(item) => item as u16,
        None => return denied("parameter 1: give an item from 0"),
    };
    if state.flies_mission() && !resets && item == missions.current(state) {
        return Ok(Todo::Nothing);
    }
    if state.flight.is_engaged {
        return Ok(Todo::one(set("plan_item", f64::from(item + 1))));
    }
    Ok(Todo::Protocol(OfProtocol::Start(item)))
}

fn set_mode(command: &Received, situation: &Situation<'_>) -> Judged {
    let (main, sub) = (number(command, 2)?, number(command, 3)?);
    // As one number, or as PX4's two.
    let custom = if main > 0xff {
        main
    } else {
        main << 16 | sub << 24
    };
    if number(command, 1)? & 1 == 0 {
        return denied("parameter 1: give a custom mode (MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)");
    }
    choose(by_custom_mode(custom), situation)
}

fn set_standard_mode(command: &Received, situation: &Situation<'_>) -> Judged {
    choose(by_standard_mode(number(command, 1)?), situation)
}

/// Changes to a mode.
pub(crate) fn choose(row: Option<&ModeRow>, situation: &Situation<'_>) -> Judged {
    let state = situation.state;
    let Some(row) = row else {
        return denied("there is no such mode: request AVAILABLE_MODES");
    };
    let Some(command) = row.command(state) else {
        return denied(format!("{}: is not for users", row.name));
    };
    let flight = &state.flight;
    match row.mode {
        mode if mode == flight.mode => Ok(Todo::Nothing),
        Mode::Plan if state.flies_mission() => Ok(Todo::Nothing),
        // Stations choose the mode first, and arm then.
        mode @ Mode::Plan if !flight.is_engaged && situation.missions.total() > 0 => {
            Ok(Todo::Protocol(OfProtocol::Choose(mode)))
        }
        mode @ Mode::Standby if !flight.is_engaged => Ok(Todo::Protocol(OfProtocol::Choose(mode))),
        // MAVSDK chooses it before it arms.
        Mode::Loiter if !flight.is_engaged && !flight.is_airborne => {
            Ok(Todo::Protocol(OfProtocol::Choose(Mode::Standby)))
        }
        Mode::Standby if flight.is_airborne => {
            denied("in the air: nothing would hold the aircraft; land, or disarm by force")
        }
        _ => in_flight(situation, command),
    }
}

fn pause_continue(command: &Received, situation: &Situation<'_>) -> Judged {
    match command.given(1) {
        Some(0.0) => in_flight(situation, set("pause", 1.0)),
        Some(1.0) if situation.state.flies_mission() => Ok(Todo::Nothing),
        Some(1.0) => in_flight(situation, set("plan_item", 0.0)),
        _ => denied("parameter 1: give 0 (pause) or 1 (continue)"),
    }
}

fn reposition(command: &Received, situation: &Situation<'_>) -> Judged {
    let state = situation.state;
    if command.given(1).is_some_and(|speed| speed > 0.0) {
        return denied("parameter 1: the speed stays as it is: give -1");
    }
    if command.given(2).is_some_and(|flags| flags != CHANGE_MODE) {
        return denied("parameter 2: give 1: going there is another mode");
    }
    if command.not_zero(3).is_some() {
        return denied("parameter 3: the radius of the circle is the aircraft's: give 0");
    }
    if command.not_zero(4).is_some() {
        return denied("parameter 4: the circle is clockwise: give 0 or NaN");
    }
    let altitude_m = command
        .altitude_m(state)?
        .unwrap_or(state.flight.altitude_m);
    let place = match [command.given(5), command.given(6), command.given(7)] {
        // Nothing at all: it stays where it is.
        [None, None, None] => return in_flight(situation, set("pause", 1.0)),
        [None, None, _] => state.motion.position.map(|here| {
            let [latitude_rad, longitude_rad] = [here.latitude_rad, here.longitude_rad];
            (latitude_rad.to_degrees(), longitude_rad.to_degrees())
        }),
        [latitude_deg, longitude_deg, _] => latitude_deg.zip(longitude_deg),
    };
    let Some((latitude_deg, longitude_deg)) = place.filter(|place| *place != (0.0, 0.0)) else {
        return denied("parameters 5 and 6: give a place, or NaN for here");
    };
    let is_place = latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0;
    if !is_place || !altitude_m.is_finite() {
        return denied("parameters 5 to 7: give degrees and metres");
    }
    let go_to = Command::set([
        ("go_to_latitude_rad", latitude_deg.to_radians()),
        ("go_to_longitude_rad", longitude_deg.to_radians()),
        ("go_to_altitude_m", altitude_m),
    ]);
    in_flight(situation, go_to)
}

/// A set point ends what is flown: only where set points are flown already.
fn set_point(situation: &Situation<'_>, name: &str, value: f64) -> Judged {
    if situation.state.flight.mode == Mode::Hold {
        return Ok(Todo::one(set(name, value)));
    }
    not_now("it would end the mission: choose the mode Cruise first")
}

fn change_speed(command: &Received, situation: &Situation<'_>) -> Judged {
    if command.not_zero(1).is_some() {
        return denied("parameter 1: give 0 (airspeed)");
    }
    if command.given(3).is_some_and(|throttle| throttle > 0.0) || command.not_zero(4).is_some() {
        return denied("parameters 3 and 4: give -1 (no throttle) and 0 (no relative speed)");
    }
    airspeed(command.given(2), situation)
}

fn guided_speed(command: &Received, situation: &Situation<'_>) -> Judged {
    if command.not_zero(1).is_some() {
        return denied("parameter 1: give 0 (airspeed)");
    }
    airspeed(command.given(2), situation)
}

fn airspeed(mps: Option<f64>, situation: &Situation<'_>) -> Judged {
    match mps.filter(|mps| *mps > 0.0) {
        Some(mps) => set_point(situation, "airspeed_mps", mps),
        None => denied("parameter 2: give an airspeed in m/s"),
    }
}

fn change_altitude(command: &Received, situation: &Situation<'_>) -> Judged {
    let state = situation.state;
    let above_m = match command.given(2) {
        Some(0.0 | 5.0) => 0.0,
        Some(3.0 | 6.0) => home_altitude_m(state),
        _ => {
            let why = "parameter 2: give frame 0 (above sea level) or 3 (above home)";
            return Err((
                Code::MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME,
                why.to_owned(),
            ));
        }
    };
    match command.given(1) {
        Some(m) => set_point(situation, "altitude_m", m + above_m),
        None => denied("parameter 1: give an altitude in m"),
    }
}

fn guided_altitude(command: &Received, situation: &Situation<'_>) -> Judged {
    match command.altitude_m(situation.state)? {
        Some(altitude_m) => set_point(situation, "altitude_m", altitude_m),
        None => denied("parameter 7: give an altitude in m"),
    }
}

fn guided_heading(command: &Received, situation: &Situation<'_>) -> Judged {
    if command.given(1) != Some(1.0) {
        return denied("parameter 1: give 1 (heading)");
    }
    let heading_deg = command.given(2).filter(|deg| (0.0..=360.0).contains(deg));
    let Some(heading_deg) = heading_deg else {
        return denied("parameter 2: give a true heading, 0 to 360 degrees");
    };
    let state = situation.state;
    let variation_rad = state.attitude.heading_rad - state.flight.magnetic_heading_rad;
    let heading_rad = heading_deg.to_radians() - variation_rad;
    set_point(situation, "heading_rad", heading_rad)
}

fn set_interval(command: &Received, _: &Situation<'_>) -> Judged {
    let us = command.given(2).unwrap_or(0.0);
    if !(-1.0..=f64::from(i32::MAX)).contains(&us) {
        return denied(
            "parameter 2: give -1 (never), 0 (the usual), or an interval in microseconds",
        );
    }
    Ok(Todo::Protocol(OfProtocol::Interval(
        number(command, 1)?,
        us as i32,
    )))
}

fn high_latency(command: &Received, _: &Situation<'_>) -> Judged {
    match command.given(1) {
        Some(0.0) => Ok(Todo::Protocol(OfProtocol::HighLatency(false))),
        Some(1.0) => Ok(Todo::Protocol(OfProtocol::HighLatency(true))),
        _ => denied("parameter 1: give 0 or 1"),
    }
}

fn operator(command: &Received, _: &Situation<'_>) -> Judged {
    let takes = match command.given(1) {
        Some(0.0) => false,
        Some(1.0) => true,
        _ => return denied("parameter 1: give 0 (release) or 1 (request)"),
    };
    let takeover = command.not_zero(2).is_some();
    Ok(Todo::Protocol(OfProtocol::Operator { takes, takeover }))
}
