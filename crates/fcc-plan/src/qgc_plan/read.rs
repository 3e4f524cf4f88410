//! Reads a `.plan`.

use std::collections::HashMap;

use jsonc_parser::{ParseOptions, parse_to_serde_value};
use serde_json::Value;

use super::landing::landing_pattern;
use super::node::Node;
use crate::command::{ALTITUDE_M, Command, RADIUS_M, Refusal, SPEED_MPS, at_most, decode, id};
use crate::item::Item;
use crate::plan::{Circle, Fence, Home, Obstacle, Plan, Polygon, RallyPoint, limits};
use crate::problem::{Problem, quoted};

/// JSON with comments, and nothing else that JSON has not.
const JSON_WITH_COMMENTS: ParseOptions = ParseOptions {
    allow_comments: true,
    allow_loose_object_property_names: false,
    allow_trailing_commas: true,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// Reads a plan.
///
/// # Errors
/// All problems, at most [`limits::PROBLEMS`].
pub(crate) fn read(text: &str) -> Result<Plan, Vec<Problem>> {
    let text = text.trim_start_matches('\u{feff}');
    let value: Value = parse_to_serde_value(text, &JSON_WITH_COMMENTS).map_err(|error| {
        vec![Problem::of(
            "",
            format!("is not JSON: {error}: give a .plan or a QGC WPL 110 file"),
        )]
    })?;
    let mut reader = Reader::default();
    let root = Node::root(&value);
    let done = reader.root(&root);
    reader.note(done);
    if reader.problems.is_empty() {
        return Ok(reader.plan);
    }
    reader.problems.truncate(limits::PROBLEMS);
    Err(reader.problems)
}

#[derive(Default)]
struct Reader {
    plan: Plan,
    problems: Vec<Problem>,
}

impl Reader {
    /// Notes a refusal and continues.
    fn note<T>(&mut self, result: Result<T, Refusal>) -> Option<T> {
        let noted = result.map_err(|(field, message)| Problem::of(field, message));
        noted.map_err(|problem| self.problems.push(problem)).ok()
    }

    fn root(&mut self, root: &Node<'_>) -> Result<(), Refusal> {
        let Some(kind) = root.optional("fileType")? else {
            let what = "lacks \"fileType\", as files of QGroundControl before 3.2 do";
            return root.refuse(format!("{what}: {SAVE_AGAIN}"));
        };
        if kind.text()? != "Plan" {
            let given = quoted(kind.text()?);
            return kind.refuse(format!(
                "\"{given}\": give a file with \"Plan\", as QGroundControl saves it"
            ));
        }
        version(root, 1)?;
        root.none_like(&[("fence", "geoFence"), ("rally", "rallyPoints")])?;
        let mission = root.key("mission")?;
        let done = self.mission(&mission);
        self.note(done);
        let done = self.fence(root);
        self.note(done);
        let done = self.rally(root);
        self.note(done);
        let done = self.own(root);
        self.note(done);
        Ok(())
    }

    fn mission(&mut self, mission: &Node<'_>) -> Result<(), Refusal> {
        if mission.optional("version")?.is_some() {
            version(mission, 2)?;
        }
        let home = mission.optional("plannedHomePosition")?;
        if let Some(home) = home.filter(|home| !home.is_unset()) {
            let (place, altitude_m) = home.position()?;
            self.plan.home = Some(Home { place, altitude_m });
        }
        if let Some(speed) = mission.optional("cruiseSpeed")? {
            self.plan.cruise_mps = Some(speed.number(&SPEED_MPS)?);
        }
        // From the numbers that jumps name to the numbers of items.
        let mut numbers = HashMap::new();
        for node in mission.key("items")?.list()? {
            let number = self.plan.items.len() + 1;
            at_most("mission.items", self.plan.items.len(), limits::ITEMS)?;
            match items_of(&node, number) {
                Ok((jump_id, items)) => {
                    // Of two with one name QGroundControl takes the first.
                    numbers.entry(jump_id).or_insert(number);
                    self.plan.items.extend(items);
                }
                Err(problem) => {
                    self.problems.push(problem);
                    // Keeps the numbers of those that follow.
                    self.plan.items.push(Item::Return);
                }
            }
            if self.problems.len() >= limits::PROBLEMS {
                return Ok(());
            }
        }
        at_most("mission.items", self.plan.items.len(), limits::ITEMS + 1)?;
        for (n, item) in self.plan.items.iter_mut().enumerate() {
            let Item::Jump { to, .. } = item else {
                continue;
            };
            if let Some(number) = numbers.get(to) {
                *to = *number;
                continue;
            }
            let what = format!("{to}: no item has this doJumpId: give one that is there");
            let problem = Problem::of_item(n + 1, "parameter 1 (item)", what);
            self.problems.push(problem);
        }
        Ok(())
    }

    fn fence(&mut self, root: &Node<'_>) -> Result<(), Refusal> {
        let Some(fence) = section(root, "geoFence")? else {
            return Ok(());
        };
        fence.only(&["version", "polygons", "circles", "breachReturn"])?;
        let mut read = Fence::default();
        let mut corners_of_all = 0;
        for node in entries(&fence, "polygons")? {
            at_most(&node.path, read.polygons.len(), limits::FENCES)?;
            node.only(&["version", "polygon", INCLUSION, GROUP])?;
            let mut corners = Vec::new();
            for corner in node.key("polygon")?.list()? {
                at_most(&corner.path, corners_of_all, limits::FENCE_CORNERS)?;
                corners_of_all += 1;
                corners.push(corner.coordinate()?.0);
            }
            if corners.is_empty() {
                continue;
            }
            if corners.len() < 3 {
                return node.refuse("give at least 3 corners");
            }
            let (inclusion, group) = inclusion(&node)?;
            read.polygons.push(Polygon {
                corners,
                inclusion,
                group,
            });
        }
        for node in entries(&fence, "circles")? {
            at_most(&node.path, read.circles.len(), limits::FENCES)?;
            node.only(&["version", "circle", INCLUSION, GROUP])?;
            let circle = node.key("circle")?;
            let (inclusion, group) = inclusion(&node)?;
            read.circles.push(Circle {
                centre: circle.key("center")?.coordinate()?.0,
                radius_m: radius(&circle)?,
                inclusion,
                group,
            });
        }
        let back = fence.optional("breachReturn")?;
        if let Some(back) = back.filter(|back| !back.is_unset()) {
            read.return_point = Some(back.position()?);
        }
        self.plan.fence = read;
        Ok(())
    }

    fn rally(&mut self, root: &Node<'_>) -> Result<(), Refusal> {
        let Some(rally) = section(root, "rallyPoints")? else {
            return Ok(());
        };
        rally.only(&["version", "points"])?;
        for node in entries(&rally, "points")? {
            at_most(&node.path, self.plan.rally.len(), limits::RALLY_POINTS)?;
            let (place, altitude_m) = node.position()?;
            self.plan.rally.push(RallyPoint { place, altitude_m });
        }
        Ok(())
    }

    /// What the format has no place for.
    fn own(&mut self, root: &Node<'_>) -> Result<(), Refusal> {
        let Some(own) = root.optional("fccd")? else {
            return Ok(());
        };
        version(&own, 1)?;
        own.only(&["version", "floor", "ceiling", "obstacles"])?;
        let altitude = |key: &str| {
            let node = own.optional(key)?;
            node.map(|node| node.number(&ALTITUDE_M)).transpose()
        };
        self.plan.fence.floor_m = altitude("floor")?;
        self.plan.fence.ceiling_m = altitude("ceiling")?;
        for node in entries(&own, "obstacles")? {
            at_most(&node.path, self.plan.obstacles.len(), limits::OBSTACLES)?;
            self.plan.obstacles.push(Obstacle {
                centre: node.key("center")?.coordinate()?.0,
                radius_m: radius(&node)?,
                top_m: node.key("top")?.number(&ALTITUDE_M)?,
            });
        }
        Ok(())
    }
}

/// The items that one of the file is, and the number that jumps name it by.
fn items_of(node: &Node<'_>, number: usize) -> Result<(usize, Vec<Item>), Problem> {
    let refused = |(field, message): Refusal| Problem::of_item(number, field, message);
    let kind = node
        .key("type")
        .and_then(|kind| kind.text())
        .map_err(refused)?;
    let jump_id = match node.optional("doJumpId").map_err(refused)? {
        Some(jump_id) => usize::from(jump_id.whole(u16::MAX).map_err(refused)?),
        None => number,
    };
    // The second in version 1 of a mission.
    if matches!(kind, "SimpleItem" | "missionItem") {
        let command = command(node).map_err(refused)?;
        return Ok((jump_id, vec![decode(number, &command)?]));
    }
    let complex = node.optional("complexItemType").map_err(refused)?;
    let kind = match complex {
        Some(kind) => kind.text().map_err(refused)?,
        None => kind,
    };
    if kind == "fwLandingPattern" {
        let items = landing_pattern(node).map_err(refused)?;
        return Ok((jump_id, items.to_vec()));
    }
    // A survey or a corridor scan, with the items that it sends.
    if let Some(transects) = node.optional(TRANSECTS).map_err(refused)? {
        let list = transects.key("Items").map_err(refused)?;
        let mut items = list.list().map_err(refused)?.peekable();
        if items.peek().is_none() {
            return Err(refused((
                list.path.clone(),
                format!("is empty: {SAVE_AGAIN}"),
            )));
        }
        let items = items.enumerate().map(|(n, item)| {
            let command = command(&item)
                .map_err(|(field, message)| Problem::of_item(number + n, field, message))?;
            decode(number + n, &command)
        });
        return Ok((jump_id, items.collect::<Result<_, _>>()?));
    }
    let what = if matches!(kind, "survey" | "CorridorScan") {
        format!("lacks \"{TRANSECTS}\", which has its items: {SAVE_AGAIN}")
    } else {
        format!(
            "\"{}\" is not supported: give a SimpleItem, a survey, a CorridorScan or a \
             fwLandingPattern",
            quoted(kind)
        )
    };
    Err(refused((format!("{}.type", node.path), what)))
}

/// What a survey and a corridor scan have in common.
const TRANSECTS: &str = "TransectStyleComplexItem";
const SAVE_AGAIN: &str = "open the file with a present QGroundControl and save it again";

/// Zones of a fence and rally points, of any version; the first also had parameters of the
/// vehicle.
const CONTENT: [&str; 6] = [
    "polygon",
    "polygons",
    "circle",
    "circles",
    "breachReturn",
    "points",
];

/// A section of the fence or the rally points: none if it is missing, empty, or of version 1
/// without content, which QGroundControl ignores.
fn section<'a>(root: &Node<'a>, key: &str) -> Result<Option<Node<'a>>, Refusal> {
    let Some(node) = root.optional(key)? else {
        return Ok(None);
    };
    let is_old = match node.optional("version")? {
        Some(version) => version.whole(u16::MAX)? == 1,
        None => true,
    };
    if !is_old {
        version(&node, 2)?;
        return Ok(Some(node));
    }
    match node.content(&CONTENT)? {
        None => Ok(None),
        Some(key) => node.refuse(format!(
            "has \"{key}\" and is of version 1 or none, which QGroundControl ignores: draw it \
             again with a present QGroundControl, and save it"
        )),
    }
}

/// The command of a simple item.
fn command(node: &Node<'_>) -> Result<Command, Refusal> {
    let id = node.key("command")?.whole(u16::MAX)?;
    if id::FENCE_AND_RALLY.contains(&id) {
        let what = format!("{id} is none of a mission: put it into geoFence or rallyPoints");
        return node.key("command")?.refuse(what);
    }
    let parameters = parameters(node)?;
    Ok(Command {
        id,
        frame: node.key("frame")?.whole(255)? as u8,
        parameters,
    })
}

const INCLUSION: &str = "inclusion";
const GROUP: &str = "inclusionGroup";

/// Whether to stay inside of a zone, and its group, for which QGroundControl has no key.
fn inclusion(zone: &Node<'_>) -> Result<(bool, u16), Refusal> {
    let inclusion = zone.key(INCLUSION)?.boolean()?;
    let group = zone.optional(GROUP)?.filter(|_| inclusion);
    let group = group.map(|group| group.whole(u16::MAX)).transpose()?;
    Ok((inclusion, group.unwrap_or(0)))
}

/// Seven parameters. Until QGroundControl 3.3 there were four, and a coordinate; in version 1
/// of a mission each of the four had a key of its own.
fn parameters(node: &Node<'_>) -> Result<[f64; 7], Refusal> {
    let mut numbers = Vec::new();
    let mut list = node.optional("params")?;
    if list.is_none() && node.optional("param1")?.is_some() {
        for key in ["param1", "param2", "param3", "param4"] {
            numbers.push(node.key(key)?.number_or_null()?);
        }
    } else {
        let params = node.key("params")?;
        for number in params.list()?.take(8) {
            numbers.push(number.number_or_null()?);
        }
    }
    if let Some(coordinate) = node.optional("coordinate")?.filter(|_| numbers.len() == 4) {
        for number in coordinate.list()?.take(4) {
            numbers.push(number.number_or_null()?);
        }
        list = Some(coordinate);
    }
    numbers.try_into().or_else(|_| {
        let at = list.unwrap_or_else(|| node.clone());
        at.refuse("give 7 numbers, or 4 and a coordinate of 3")
    })
}

/// A radius above zero.
fn radius(node: &Node<'_>) -> Result<f64, Refusal> {
    let radius = node.key("radius")?;
    match radius.number(&RADIUS_M)? {
        0.0 => radius.refuse("0: give the radius in m"),
        radius_m => Ok(radius_m),
    }
}

/// The entries of a list that may be missing.
fn entries<'a>(
    node: &Node<'a>,
    key: &str,
) -> Result<impl Iterator<Item = Node<'a>> + use<'a>, Refusal> {
    let list = node.optional(key)?;
    let entries = list.map(|list| list.list()).transpose()?;
    Ok(entries.into_iter().flatten())
}

/// Only the present version is read: an older one has other keys.
fn version(node: &Node<'_>, version: u16) -> Result<(), Refusal> {
    let found = node.key("version")?;
    // As the first versions wrote it.
    if version == 1 && found.text() == Ok("1.0") {
        return Ok(());
    }
    match found.whole(u16::MAX)? {
        number if number == version => Ok(()),
        other => found.refuse(format!(
            "{other}: only version {version} is read: {SAVE_AGAIN}"
        )),
    }
}
