//! Items of missions, fences and rally points as MAVLink sends them.

use fcc_plan::mission::Command;
use fcc_plan::{Plan, Problem, mission};
use mavlink::dialects::common::MavMissionResult;

use crate::effects::Peer;
use crate::frame::{Body, Fields};

/// `MAV_FRAME_MISSION`: its numbers are not scaled.
const FRAME_MISSION: u8 = 2;
const ITEM_INT: (u32, u8) = (73, 38);

/// What a list is of: `MAV_MISSION_TYPE`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Part {
    Mission = 0,
    Fence = 1,
    Rally = 2,
}

impl Part {
    pub(crate) const ALL: [Self; 3] = [Self::Mission, Self::Fence, Self::Rally];

    pub(crate) fn of(number: u8) -> Option<Self> {
        Self::ALL.get(usize::from(number)).copied()
    }

    /// The list that items with a command are of.
    const fn of_command(number: u16) -> Self {
        match number {
            5000..=5004 => Self::Fence,
            5100 => Self::Rally,
            _ => Self::Mission,
        }
    }
}

/// An item as it was sent: it is given back the same.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MissionItem {
    command: u16,
    frame: u8,
    parameters: [f32; 4],
    x: i32,
    y: i32,
    z: f32,
    autocontinue: u8,
}

/// By bits: NaN is equal to itself.
impl PartialEq for MissionItem {
    fn eq(&self, other: &Self) -> bool {
        self.payload_fields() == other.payload_fields()
    }
}

impl MissionItem {
    fn payload_fields(&self) -> [u8; 32] {
        let mut all = [0; 32];
        let [a, b, c, d] = self.parameters;
        let words = [a.to_bits(), b.to_bits(), c.to_bits(), d.to_bits()].into_iter();
        let words = words.chain([self.x.cast_unsigned(), self.y.cast_unsigned()]);
        let bytes = words.chain([self.z.to_bits()]).flat_map(u32::to_le_bytes);
        let rest = [self.frame, self.autocontinue];
        let bytes = bytes.chain(self.command.to_le_bytes()).chain(rest);
        for (to, from) in all.iter_mut().zip(bytes) {
            *to = from;
        }
        all
    }

    /// From the payload of `MISSION_ITEM_INT`, with its sequence number; or of the older
    /// `MISSION_ITEM`, whose place is in degrees.
    pub(crate) fn read(fields: &Fields, is_in_degrees: bool) -> (u16, Self) {
        let is_scaled = fields.u8(34) != FRAME_MISSION;
        let whole = |at| match fields.f32(at) {
            _ if !is_in_degrees => fields.i32(at),
            number if number.is_nan() => i32::MAX,
            number if is_scaled => (f64::from(number) * 1e7).round() as i32,
            number => number as i32,
        };
        let item = Self {
            parameters: [0, 4, 8, 12].map(|at| fields.f32(at)),
            x: whole(16),
            y: whole(20),
            z: fields.f32(24),
            command: fields.u16(30),
            frame: fields.u8(34),
            autocontinue: fields.u8(36),
        };
        (fields.u16(28), item)
    }

    /// `MISSION_ITEM_INT`.
    pub(crate) fn body(&self, peer: Peer, seq: u16, is_current: bool, part: Part) -> Body {
        let mut payload = Vec::with_capacity(38);
        for parameter in self.parameters {
            payload.extend(parameter.to_le_bytes());
        }
        payload.extend(self.x.to_le_bytes());
        payload.extend(self.y.to_le_bytes());
        payload.extend(self.z.to_le_bytes());
        payload.extend(seq.to_le_bytes());
        payload.extend(self.command.to_le_bytes());
        payload.extend(peer.address());
        payload.extend([self.frame, u8::from(is_current), self.autocontinue]);
        payload.push(part as u8);
        Body::raw(ITEM_INT.0, ITEM_INT.1, &payload)
    }

    fn command(&self) -> Command {
        let [a, b, c, d] = self.parameters.map(f64::from);
        let place = [self.x, self.y].map(|number| match number {
            i32::MAX => f64::NAN,
            number if self.frame == FRAME_MISSION => number.into(),
            number => f64::from(number) / 1e7,
        });
        let [e, f] = place;
        Command {
            id: self.command,
            frame: self.frame,
            parameters: [a, b, c, d, e, f, self.z.into()],
        }
    }

    fn of(command: &Command) -> Self {
        let [a, b, c, d, e, f, g] = command.parameters;
        let [x, y] = [e, f].map(|number| {
            let is_unscaled = command.frame == FRAME_MISSION;
            let scale = if is_unscaled { 1.0 } else { 1e7 };
            (number * scale).round() as i32
        });
        Self {
            command: command.id,
            frame: command.frame,
            parameters: [a, b, c, d].map(|number| number as f32),
            x,
            y,
            z: g as f32,
            autocontinue: 1,
        }
    }
}

/// Parameters, from 1, that are not carried out, though the command is: they are refused
/// unless they are 0 or NaN. Parameter 4 of loiters, where they are left, is ignored as it is
/// in files: `QGroundControl` sets it in every plan.
const NOT_CARRIED_OUT: [(u16, &[usize]); 6] = [
    (16, &[4]),
    (17, &[1, 2, 4]),
    (20, &[1, 2, 3, 4]),
    (21, &[2, 3, 4]),
    (22, &[2, 3, 4]),
    (189, &[1, 2, 3, 4]),
];

/// Why a list is refused: the code, and why in words.
pub(crate) type Refused = (MavMissionResult, String);

/// Puts a list into a plan.
pub(crate) fn put(plan: &mut Plan, part: Part, list: &[MissionItem]) -> Result<(), Refused> {
    let commands: Vec<Command> = list.iter().map(MissionItem::command).collect();
    let is_other = |command: &&Command| Part::of_command(command.id) != part;
    if let Some(other) = commands.iter().find(is_other) {
        let text = format!("command {} is not of this list", other.id);
        return Err((MavMissionResult::MAV_MISSION_UNSUPPORTED, text));
    }
    let read = match part {
        Part::Mission => not_carried_out(&commands)
            .map_or_else(|| mission::items(&commands), Err)
            .map(|items| plan.items = items),
        Part::Fence => mission::fence(&commands).map(|fence| {
            plan.fence = fcc_plan::Fence {
                floor_m: plan.fence.floor_m,
                ceiling_m: plan.fence.ceiling_m,
                ..fence
            };
        }),
        Part::Rally => mission::rally(&commands).map(|rally| plan.rally = rally),
    };
    read.map_err(|problem| (code(&problem), problem.to_string()))
}

fn not_carried_out(commands: &[Command]) -> Option<Problem> {
    commands.iter().enumerate().find_map(|(n, command)| {
        let mut rows = NOT_CARRIED_OUT.iter();
        let (_, numbers) = rows.find(|(id, _)| *id == command.id)?;
        numbers.iter().find_map(|number| {
            let given = *command.parameters.get(number - 1)?;
            let is_unset = given == 0.0 || given.is_nan();
            let message = || format!("{given}: is not carried out: give 0 or NaN");
            let field = || format!("parameter {number}");
            (!is_unset).then(|| Problem::of_item(n + 1, field(), message()))
        })
    })
}

/// The code for a problem, by the field that it names.
fn code(problem: &Problem) -> MavMissionResult {
    type Code = MavMissionResult;
    let field = problem.field.as_str();
    let number = field
        .strip_prefix("parameter ")
        .and_then(|rest| rest.chars().next());
    match (number, field) {
        (Some('1'), _) => Code::MAV_MISSION_INVALID_PARAM1,
        (Some('2'), _) => Code::MAV_MISSION_INVALID_PARAM2,
        (Some('3'), _) => Code::MAV_MISSION_INVALID_PARAM3,
        (Some('4'), _) => Code::MAV_MISSION_INVALID_PARAM4,
        (_, "latitude" | "place") => Code::MAV_MISSION_INVALID_PARAM5_X,
        (_, "longitude") => Code::MAV_MISSION_INVALID_PARAM6_Y,
        (_, "altitude" | "altitude above home") => Code::MAV_MISSION_INVALID_PARAM7,
        (_, "frame") => Code::MAV_MISSION_UNSUPPORTED_FRAME,
        (_, "command") => Code::MAV_MISSION_UNSUPPORTED,
        _ => Code::MAV_MISSION_INVALID,
    }
}

/// The lists of a plan, in the order of [`Part::ALL`].
pub(crate) fn lists(plan: &Plan) -> [Vec<MissionItem>; 3] {
    mission::lists(plan).map(|list| list.iter().map(MissionItem::of).collect())
}

/// The opaque id of one part of a plan: of its hash; 0 if it is empty.
pub(crate) fn opaque_id(plan: &Plan, part: Part) -> u32 {
    let mut alone = Plan::default();
    match part {
        Part::Mission => alone.items.clone_from(&plan.items),
        Part::Fence => alone.fence.clone_from(&plan.fence),
        Part::Rally => alone.rally.clone_from(&plan.rally),
    }
    if alone == Plan::default() {
        return 0;
    }
    ((alone.hash().first_64_bits() >> 32) as u32).max(1)
}
