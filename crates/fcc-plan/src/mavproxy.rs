//! Fences and rally points as older versions of MAVProxy saved them: text, a place a line
//! (pymavlink, `mavwp.py`).

use crate::command::{Command, FenceReader, Refusal, frame, id};
use crate::plan::Plan;
use crate::problem::{Problem, quoted};

/// What a line of rally points begins with.
const RALLY: &str = "RALLY";

/// Reads a plan without items; none if it is a text of another format.
pub(crate) fn read(text: &str) -> Option<Result<Plan, Vec<Problem>>> {
    let lines = text
        .lines()
        .map(|line| line.trim_start_matches('\u{feff}').trim())
        .enumerate()
        .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    let lines: Vec<(usize, Vec<&str>)> = lines
        .map(|(n, line)| (n + 1, line.split_whitespace().take(8).collect()))
        .collect();
    let is_number = |word: &&str| word.parse::<f64>().is_ok();
    let read = match lines.first()?.1.as_slice() {
        [RALLY, ..] => rally(&lines),
        [latitude, longitude] if [latitude, longitude].into_iter().all(is_number) => fence(&lines),
        _ => return None,
    };
    Some(read.map_err(|problem| vec![problem]))
}

type Lines<'a> = [(usize, Vec<&'a str>)];

/// The numbers of a line.
fn numbers<const N: usize>(line: usize, words: &[&str], what: &str) -> Result<[f64; N], Problem> {
    let parsed = words.iter().map(|word| word.parse::<f64>().ok());
    let parsed: Option<Vec<f64>> = parsed.collect();
    parsed
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| {
            let given = quoted(&words.join(" "));
            Problem::of(format!("line {line}"), format!("\"{given}\": give {what}"))
        })
}

/// Takes a line as the command that it would be today.
fn take(reader: &mut FenceReader, line: usize, command: &Command) -> Result<(), Problem> {
    let refused = |(field, message): Refusal| Problem::of(format!("line {line}: {field}"), message);
    reader.take(command).map_err(refused)
}

fn plan(reader: FenceReader) -> Plan {
    Plan {
        fence: reader.fence,
        rally: reader.rally,
        ..Plan::default()
    }
}

/// The place to return to, and the corners of a polygon, the first of which is repeated.
fn fence(lines: &Lines<'_>) -> Result<Plan, Problem> {
    let mut places = Vec::new();
    for (line, words) in lines {
        let place: [f64; 2] = numbers(*line, words, "latitude and longitude")?;
        places.push((*line, place));
    }
    let closed = match places.as_slice() {
        [back, corners @ .., last]
            if corners.len() > 2 && corners.first().map(|c| c.1) == Some(last.1) =>
        {
            Some((back, corners))
        }
        _ => None,
    };
    let Some((back, corners)) = closed else {
        let what = "is no fence of MAVProxy: give the place to return to, at least 3 corners, and \
                    the first corner again";
        return Err(Problem::of("", what));
    };
    let mut reader = FenceReader::default();
    let command = |id: u16, first: f64, [latitude, longitude]: [f64; 2]| Command {
        id,
        frame: frame::GLOBAL,
        parameters: [first, 0.0, 0.0, 0.0, latitude, longitude, 0.0],
    };
    take(
        &mut reader,
        back.0,
        &command(id::FENCE_RETURN_POINT, 0.0, back.1),
    )?;
    let count = corners.len() as f64;
    for (line, corner) in corners {
        take(
            &mut reader,
            *line,
            &command(id::FENCE_POLYGON_INCLUSION, count, *corner),
        )?;
    }
    Ok(plan(reader))
}

/// Rally points; where an aircraft would land from there is not used.
fn rally(lines: &Lines<'_>) -> Result<Plan, Problem> {
    let mut reader = FenceReader::default();
    for (line, words) in lines {
        let words = words.strip_prefix(&[RALLY]).unwrap_or_default();
        let what = "RALLY, latitude, longitude, altitude above home, and three numbers more";
        let [latitude, longitude, altitude_m, ..]: [f64; 6] = numbers(*line, words, what)?;
        let command = Command {
            id: id::RALLY_POINT,
            frame: frame::RELATIVE,
            parameters: [0.0, 0.0, 0.0, 0.0, latitude, longitude, altitude_m],
        };
        take(&mut reader, *line, &command)?;
    }
    Ok(plan(reader))
}
