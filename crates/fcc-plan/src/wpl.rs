//! `QGC WPL 110`: text, a line per command (MAVLink, "Mission Plain-Text File
//! Format").
//!
//! Line 0 is home, as Mission Planner, MAVProxy and QGroundControl write it. Commands of a
//! fence and rally points follow the items; MAVProxy saves them alone, without home.

use std::fmt::Write as _;

use crate::command::{
    ALTITUDE_M, Command, FenceReader, Refusal, at_most, check, decode, encode, fence_commands,
    frame, id, place, rally_commands,
};
use crate::item::Item;
use crate::plan::{Home, Plan, limits};
use crate::problem::{Problem, quoted};

/// The first line.
pub(crate) const HEADER: &str = "QGC WPL 110";

/// Reads a plan.
///
/// # Errors
/// All problems, at most [`limits::PROBLEMS`].
pub(crate) fn read(text: &str) -> Result<Plan, Vec<Problem>> {
    let mut lines = text
        .lines()
        .map(|line| line.trim_start_matches('\u{feff}').trim())
        .enumerate()
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let (at, first) = lines.next().unwrap_or_default();
    let place = format!("line {}", at + 1);
    if let Some(version) = first.strip_prefix("QGC WPL ").filter(|v| *v != "110") {
        // QGroundControl's before it had a home, and MAVROS'.
        let what = if version == "120" {
            format!(
                "version 120 has no home: write {HEADER}, put home before the items (place 0, 0: \
                 not set), and number the lines, and the targets of jumps, from 0"
            )
        } else {
            format!(
                "version {}: only {HEADER} is read: load the file into a present ground station \
                 and save it again",
                quoted(version)
            )
        };
        return Err(vec![Problem::of(place, what)]);
    }
    if first.split_whitespace().ne(HEADER.split_whitespace()) {
        let what = format!(
            "\"{}\": the first line has to be {HEADER}, or that of a QGroundControl plan {{",
            quoted(first)
        );
        return Err(vec![Problem::of(place, what)]);
    }
    let mut reader = Reader::default();
    for (line, content) in lines {
        if let Err(problem) = reader.line(content) {
            let place = format!("line {}", line + 1);
            reader.problems.push(Problem {
                field: match problem.field.as_str() {
                    "" => place,
                    field => format!("{place}: {field}"),
                },
                ..problem
            });
            // Keeps the numbers of those that follow.
            if reader.fence == FenceReader::default() && reader.count > 1 {
                reader.plan.items.resize(reader.count - 1, Item::Return);
            }
            if reader.problems.len() >= limits::PROBLEMS {
                break;
            }
        }
    }
    if let Err((field, message)) = reader.fence.complete()
        && reader.problems.is_empty()
    {
        reader.problems.push(Problem::of(field, message));
    }
    let items = &reader.plan.items;
    for (n, item) in items.iter().enumerate() {
        let Item::Jump { to, .. } = item else {
            continue;
        };
        if *to > items.len() {
            let what = format!("{to}: there is no such item: give 1 to {}", items.len());
            reader
                .problems
                .push(Problem::of_item(n + 1, "parameter 1 (item)", what));
        }
    }
    if !reader.problems.is_empty() {
        reader.problems.truncate(limits::PROBLEMS);
        return Err(reader.problems);
    }
    reader.plan.fence = reader.fence.fence;
    reader.plan.rally = reader.fence.rally;
    Ok(reader.plan)
}

#[derive(Default)]
struct Reader {
    plan: Plan,
    fence: FenceReader,
    problems: Vec<Problem>,
    /// Lines until now, home included.
    count: usize,
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<(), Problem> {
        let number = self.count;
        self.count += 1;
        let refused = |(field, message): Refusal| Problem {
            item: Some(number).filter(|number| *number > 0),
            field,
            message,
        };
        let (index, command) = fields(line).map_err(refused)?;
        if number == 0 && index == 1.0 {
            // Said once: the other lines are numbered as if it were there.
            self.count = 2;
            let what = "1: the line of home, number 0, is missing: put it before this one (place 0, \
                        0: not set)";
            return Err(refused(("index".to_owned(), what.to_owned())));
        }
        if index != number as f64 {
            let what = format!("{index}: this line is number {number}: number the lines from 0");
            return Err(refused(("index".to_owned(), what)));
        }
        if number == 0 && !id::FENCE_AND_RALLY.contains(&command.id) {
            self.plan.home = home(&command).map_err(refused)?;
            return Ok(());
        }
        if id::FENCE_AND_RALLY.contains(&command.id) {
            return self.fence.take(&command).map_err(refused);
        }
        if self.fence != FenceReader::default() {
            let what = "follows a fence or rally points: put these behind all items";
            return Err(refused(("command".to_owned(), what.to_owned())));
        }
        at_most("items", self.plan.items.len(), limits::ITEMS).map_err(refused)?;
        self.plan.items.push(decode(number, &command)?);
        Ok(())
    }
}

/// Index and command of a line.
fn fields(line: &str) -> Result<(f64, Command), Refusal> {
    const NAMES: [&str; 12] = [
        "index",
        "current",
        "frame",
        "command",
        "parameter 1",
        "parameter 2",
        "parameter 3",
        "parameter 4",
        "latitude",
        "longitude",
        "altitude",
        "autocontinue",
    ];
    let words: Vec<&str> = line.split_whitespace().take(13).collect();
    let words: [&str; 12] = words.try_into().map_err(|words: Vec<&str>| {
        let count = words.len();
        let count = if count > 12 {
            "more than 12".to_owned()
        } else {
            count.to_string()
        };
        let what = format!("has {count} numbers: give 12");
        (String::new(), what)
    })?;
    let mut numbers = [0.0; 12];
    for ((number, word), name) in numbers.iter_mut().zip(words).zip(NAMES) {
        let parsed = word.parse::<f64>().ok().filter(|x| !x.is_infinite());
        *number = parsed.ok_or_else(|| {
            let what = format!("\"{}\": give a number", quoted(word));
            (name.to_owned(), what)
        })?;
    }
    let [index, _, frame, id, a, b, c, d, e, f, g, _] = numbers;
    let whole = |name: &str, value: f64, most: f64| {
        check(name, value, &(0.0..=most)).and_then(|value| match value.fract() {
            0.0 => Ok(value),
            _ => Err((name.to_owned(), format!("{value}: give a whole number"))),
        })
    };
    let command = Command {
        id: whole("command", id, 65_535.0)? as u16,
        frame: whole("frame", frame, 255.0)? as u8,
        parameters: [a, b, c, d, e, f, g],
    };
    Ok((index, command))
}

/// Home; none where it was not set, which is written as zeros. The files of PX4 and MAVROS
/// begin with an item instead.
fn home(command: &Command) -> Result<Option<Home>, Refusal> {
    let no_home = |field: &str, given: String| {
        let what = format!(
            "{given}, and line 0 is home: if it is the first item, put home before it (place 0, 0: \
             not set), and number the lines from 0"
        );
        Err((field.to_owned(), what))
    };
    // Mission Planner writes 0 for the command.
    if !matches!(command.id, 0 | id::WAYPOINT) {
        return no_home("command", format!("{} is not 16", command.id));
    }
    let [first @ .., latitude, longitude, altitude_m] = command.parameters;
    if (latitude, longitude) == (0.0, 0.0) {
        return Ok(None);
    }
    if !matches!(command.frame, frame::GLOBAL | frame::GLOBAL_INT) {
        let given = format!("{} is not above sea level (0)", command.frame);
        return no_home("frame", given);
    }
    if let Some(n) = first.iter().position(|number| number.abs() > 0.0) {
        let given = format!("{} is not 0", first.get(n).unwrap_or(&f64::NAN));
        return no_home(&format!("parameter {}", n + 1), given);
    }
    Ok(Some(Home {
        place: place(latitude, longitude)?,
        altitude_m: check("altitude", altitude_m, &ALTITUDE_M)?,
    }))
}

/// Writes a plan.
///
/// # Errors
/// What this format has no place for.
pub(crate) fn write(plan: &Plan) -> Result<String, Vec<Problem>> {
    let lost = [
        ("cruise speed", plan.cruise_mps.is_some()),
        ("floor of the fence", plan.fence.floor_m.is_some()),
        ("ceiling of the fence", plan.fence.ceiling_m.is_some()),
        ("obstacles", !plan.obstacles.is_empty()),
    ];
    let lost: Vec<Problem> = lost
        .into_iter()
        .filter(|(_, is_lost)| *is_lost)
        .map(|(name, _)| {
            let what = format!("{HEADER} has no place for it: write a .plan, or remove it");
            Problem::of(name, what)
        })
        .collect();
    if !lost.is_empty() {
        return Err(lost);
    }
    let home = plan.home.map_or([0.0; 7], |Home { place, altitude_m }| {
        let (latitude, longitude) = (place.latitude_deg, place.longitude_deg);
        [0.0, 0.0, 0.0, 0.0, latitude, longitude, altitude_m]
    });
    let home = Command {
        id: id::WAYPOINT,
        frame: 0,
        parameters: home,
    };
    let items = plan.items.iter().map(encode);
    let commands = items
        .chain(fence_commands(&plan.fence))
        .chain(rally_commands(&plan.rally));
    let mut text = format!("{HEADER}\n");
    for (n, command) in [home].into_iter().chain(commands).enumerate() {
        let Command {
            id,
            frame,
            parameters,
        } = command;
        let current = u8::from(n == 0);
        let _ = write!(text, "{n}\t{current}\t{frame}\t{id}");
        for parameter in parameters {
            let _ = write!(text, "\t{parameter}");
        }
        text.push_str("\t1\n");
    }
    Ok(text)
}
