//! `fccd plan`: checks, shows and converts flight plans.

use std::fmt::Write as _;
use std::path::Path;

use fcc_core::flight::terrain::Terrain;
use fcc_flight::config::{BuiltInSection, Config};
use fcc_plan::{AltitudeDatum, FileError, Format, Item, Place, Plan, Problem};
use fcc_report::{GroundLine, PlanLine, PlanLines, PlanPlace, PlanRow, plan_page, plan_table};
use serde::Serialize;

use super::failure::Failure;
use crate::cli::plan::{PlanAction, PlanArgs, PlanCheckArgs, PlanConvertArgs, PlanShowArgs};
use crate::exit::Exit;
use crate::output;

/// Carries out a command of `fccd plan`.
pub(super) fn plan(args: &PlanArgs) -> Result<Exit, Failure> {
    match &args.what {
        PlanAction::Check(args) => check(args),
        PlanAction::Show(args) => show(args),
        PlanAction::Convert(args) => convert(args),
    }
}

/// That of a file, or the Cessna's.
fn configuration(file: Option<&Path>) -> Result<Config, Failure> {
    Ok(match file {
        Some(path) => Config::load(path)?,
        None => Config {
            built_in: Some(BuiltInSection::default()),
            ..Config::default()
        },
    })
}

#[derive(Serialize)]
struct Checked {
    file: String,
    ok: bool,
    /// Of a plan that could be read.
    sha256: Option<String>,
    items: usize,
    problems: Vec<Problem>,
    /// What is accepted, and worth a look.
    remarks: Vec<String>,
}

/// Checks plans: the exit code is that of the worst.
fn check(args: &PlanCheckArgs) -> Result<Exit, Failure> {
    let config = configuration(args.config.as_deref())?;
    let mut exit = Exit::Success;
    let mut all = Vec::new();
    for path in &args.files {
        let (checked, worst) = check_file(path, &config);
        if worst != Exit::Success && exit != Exit::Failure {
            exit = worst;
        }
        if !args.json {
            exit = print(&checked, exit);
        }
        all.push(checked);
    }
    Ok(match all.as_slice() {
        _ if !args.json => exit,
        [one] => output::json(one, exit),
        several => output::json(&several, exit),
    })
}

fn print(checked: &Checked, exit: Exit) -> Exit {
    let file = &checked.file;
    if let (true, Some(sha256)) = (checked.ok, &checked.sha256) {
        let hash = sha256.get(..12).unwrap_or_default();
        let mut text = format!("{file}: valid: {} items, {hash}", checked.items);
        for remark in &checked.remarks {
            let _ = write!(text, "\n{file}: {remark}");
        }
        return output::result(text, exit);
    }
    for problem in &checked.problems {
        output::message(format_args!("{file}: {problem}"));
    }
    exit
}

fn check_file(path: &Path, config: &Config) -> (Checked, Exit) {
    let file = path.display().to_string();
    let unread = |problems| Checked {
        file: file.clone(),
        ok: false,
        sha256: None,
        items: 0,
        problems,
        remarks: Vec::new(),
    };
    let plan = match fcc_plan::read_file(path) {
        Ok(plan) => plan,
        Err(FileError::Invalid { problems, .. }) => return (unread(problems), Exit::Usage),
        Err(error) => {
            let error = error.to_string();
            let message = error.strip_prefix(&format!("{file}: ")).unwrap_or(&error);
            let problem = Problem::of("", message);
            return (unread(vec![problem]), Exit::Failure);
        }
    };
    let (plan, problems, exit) = match config.checked_plan(&plan) {
        Ok(flown) => (flown, Vec::new(), Exit::Success),
        Err(problems) => (plan, problems, Exit::Usage),
    };
    let remarks = if problems.is_empty() {
        config.plan_remarks(&plan)
    } else {
        Vec::new()
    };
    let checked = Checked {
        file,
        remarks,
        ok: problems.is_empty(),
        sha256: Some(plan.hash().to_string()),
        items: plan.items.len(),
        problems,
    };
    (checked, exit)
}

#[derive(Serialize)]
struct Shown<'a> {
    file: String,
    sha256: String,
    plan: &'a Plan,
}

/// Shows a plan.
fn show(args: &PlanShowArgs) -> Result<Exit, Failure> {
    let plan = read(&args.file)?;
    let hash = plan.hash();
    let name = args.file.display();
    let rows = rows(&plan);
    let table = plan_table(&rows);
    let mut written = String::new();
    if let Some(out) = &args.html {
        let title = format!("{name}, {hash:.12}");
        let config = configuration(args.config.as_deref())?;
        let invalid =
            |problem: Problem| Failure::of(Exit::Usage, format_args!("{name}: {problem}"));
        let (flown, ground) = config
            .with_ground(&plan, |terrain| over_ground(&plan, terrain))
            .map_err(invalid)?;
        let page = plan_page(&title, &rows, &places(&flown), &fence(&plan), &ground);
        write(out, &args.file, &page)?;
        let _ = write!(written, "\nwritten: {}", out.display());
    }
    if args.json {
        let shown = Shown {
            file: name.to_string(),
            sha256: hash.to_string(),
            plan: &plan,
        };
        return Ok(output::json(&shown, Exit::Success));
    }
    let text = format!(
        "{name}: {} items, {hash:.12}\n{table}{written}",
        plan.items.len()
    );
    Ok(output::result(text, Exit::Success))
}

#[derive(Serialize)]
struct Converted {
    file: String,
    written: String,
    sha256: String,
}

/// Writes a plan in the format of the other file's name.
fn convert(args: &PlanConvertArgs) -> Result<Exit, Failure> {
    let format = Format::of_name(&args.out).ok_or_else(|| {
        let message = format_args!(
            "{}: the format is not known by its name: end it with .plan, .waypoints, .wpl or .txt",
            args.out.display()
        );
        Failure::of(Exit::Usage, message)
    })?;
    let plan = read(&args.file)?;
    let text = fcc_plan::write(&plan, format).map_err(|problems| {
        let lines: Vec<_> = problems
            .iter()
            .map(|problem| format!("{}: {problem}", args.file.display()))
            .collect();
        Failure::of(Exit::Usage, lines.join("\n"))
    })?;
    write(&args.out, &args.file, &text)?;
    let converted = Converted {
        file: args.file.display().to_string(),
        written: args.out.display().to_string(),
        sha256: plan.hash().to_string(),
    };
    if args.json {
        return Ok(output::json(&converted, Exit::Success));
    }
    let text = format!("written: {}", converted.written);
    Ok(output::result(text, Exit::Success))
}

fn read(path: &Path) -> Result<Plan, Failure> {
    fcc_plan::read_file(path).map_err(|error| {
        let exit = match error {
            FileError::Invalid { .. } => Exit::Usage,
            _ => Exit::Failure,
        };
        Failure::of(exit, error)
    })
}

/// Writes a file that is not the plan itself.
fn write(out: &Path, plan: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| {
        Failure::new(format_args!(
            "{}: cannot be written: {error}",
            out.display()
        ))
    };
    let mut file = fcc_record::create_output(out, &[plan]).map_err(failed)?;
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(failed)
}

/// A row of the table for each item.
fn rows(plan: &Plan) -> Vec<PlanRow> {
    let mut before: Option<Place> = plan.home.map(|home| home.place);
    let row = |(n, item): (usize, &Item)| {
        let place = item.place();
        let leg = place
            .zip(before)
            .map(|(to, from)| from.to(to))
            .filter(|(length_m, ..)| *length_m > 0.1);
        before = place.or(before);
        let altitude = item.altitude().map_or_else(String::new, |altitude| {
            let above = match altitude.above {
                AltitudeDatum::SeaLevel => "",
                AltitudeDatum::Home => " above home",
                AltitudeDatum::Terrain => " above terrain",
            };
            format!("{:.1} m{above}", altitude.m)
        });
        [
            (n + 1).to_string(),
            item.to_string(),
            place.map_or_else(String::new, |place| {
                format!("{:.6}, {:.6}", place.latitude_deg, place.longitude_deg)
            }),
            altitude,
            leg.map_or_else(String::new, |(length_m, ..)| {
                format!("{:.2} km", length_m / 1e3)
            }),
            leg.map_or_else(String::new, |(_, course_deg, _)| {
                format!("{:.1}°", course_deg.rem_euclid(360.0))
            }),
        ]
    };
    plan.items.iter().enumerate().map(row).collect()
}

/// The places of a plan for its picture.
fn places(plan: &Plan) -> Vec<PlanPlace> {
    let home = plan
        .home
        .map(|home| (None, home.place, home.altitude_m, None));
    let mut level_m = plan.home.map_or(0.0, |home| home.altitude_m);
    let home_m = level_m;
    let items = plan.items.iter().enumerate().filter_map(|(n, item)| {
        if let Some(altitude) = item.altitude() {
            let above_m = match altitude.above {
                AltitudeDatum::SeaLevel => 0.0,
                AltitudeDatum::Home | AltitudeDatum::Terrain => home_m,
            };
            level_m = altitude.m + above_m;
        }
        let circle_m = match item {
            Item::Loiter(loiter) => loiter.radius_m,
            _ => None,
        };
        item.place()
            .map(|place| (Some(n + 1), place, level_m, circle_m))
    });
    let all: Vec<_> = home.into_iter().chain(items).collect();
    let Some((_, origin, ..)) = all.first().copied() else {
        return Vec::new();
    };
    let mut along_m = 0.0;
    let mut last = origin;
    let place = |(item, place, altitude_m, circle_m): (_, Place, _, _)| {
        let (east_m, north_m) = from(origin, place);
        along_m += last.to(place).0;
        last = place;
        PlanPlace {
            item,
            north_m,
            east_m,
            altitude_m,
            along_m,
            circle_m,
        }
    };
    all.into_iter().map(place).collect()
}

/// The plan with its altitudes above mean sea level as far as they are known, and the
/// ground below its legs: the way to here and the elevation, m, and nothing where that is
/// not known.
fn over_ground(plan: &Plan, terrain: Option<&Terrain<'_>>) -> (Plan, Vec<(f64, Option<f64>)>) {
    /// Between points of the profile, m, and how many of a leg at most.
    const STEP_M: f64 = 50.0;
    const MOST_POINTS: f64 = 2_000.0;
    let Some(terrain) = terrain else {
        return (plan.clone(), Vec::new());
    };
    let flown = fcc_plan::resolve(plan, terrain).unwrap_or_else(|_| plan.clone());
    let home = plan.home.map(|home| home.place);
    let all = home
        .into_iter()
        .chain(plan.items.iter().filter_map(Item::place));
    let all: Vec<_> = all.collect();
    let (mut ground, mut along_m) = (Vec::new(), 0.0);
    for (from, to) in all.iter().zip(all.iter().skip(1)) {
        let (length_m, course_deg, _) = from.to(*to);
        let steps = (length_m / STEP_M).ceil().clamp(1.0, MOST_POINTS) as u32;
        for step in 0..=steps {
            let at_m = length_m * f64::from(step) / f64::from(steps);
            let place = from.ahead(course_deg, at_m);
            let elevation_m = terrain.elevation_m(
                place.latitude_deg.to_radians(),
                place.longitude_deg.to_radians(),
            );
            ground.push((along_m + at_m, elevation_m));
        }
        along_m += length_m;
    }
    (flown, ground)
}

/// A place, m east and north of another one.
fn from(origin: Place, place: Place) -> (f64, f64) {
    let (distance_m, course_deg, _) = origin.to(place);
    let (sine, cosine) = course_deg.to_radians().sin_cos();
    (distance_m * sine, distance_m * cosine)
}

/// The sides of the fence, from the plan's first place.
fn fence(plan: &Plan) -> Vec<PlanLine> {
    let home = plan.home.map(|home| home.place);
    let first = home.or_else(|| plan.items.iter().find_map(Item::place));
    let Some(origin) = first else {
        return Vec::new();
    };
    let line = |places: Vec<Place>| {
        places
            .into_iter()
            .map(|place| from(origin, place))
            .collect()
    };
    sides(plan).map(line).collect()
}

/// The sides of the fence, each closed.
fn sides(plan: &Plan) -> impl Iterator<Item = Vec<Place>> + '_ {
    let polygons = plan.fence.polygons.iter().map(|polygon| {
        let closed = polygon.corners.iter().chain(polygon.corners.first());
        closed.copied().collect()
    });
    let circles = plan.fence.circles.iter();
    polygons.chain(circles.map(|around| circle(around.centre, around.radius_m)))
}

/// Corners of a circle that is drawn.
const CORNERS: u32 = 90;

fn circle(centre: Place, radius_m: f64) -> Vec<Place> {
    let course_deg = |corner| 360.0 * f64::from(corner) / f64::from(CORNERS);
    let corners = (0..=CORNERS).map(|corner| centre.ahead(course_deg(corner), radius_m));
    corners.collect()
}

/// A plan on the ground: its legs, the circles of its loiters, and its fence.
pub(super) fn lines(plan: &Plan) -> PlanLines {
    let line = |places: Vec<Place>| -> GroundLine {
        let at = |place: Place| {
            (
                place.latitude_deg.to_radians(),
                place.longitude_deg.to_radians(),
            )
        };
        places.into_iter().map(at).collect()
    };
    let home = plan.home.map(|home| home.place);
    let places = plan.items.iter().filter_map(Item::place);
    let legs = home.into_iter().chain(places).collect();
    let loiters = plan.items.iter().filter_map(|item| match item {
        Item::Loiter(loiter) => Some(circle(loiter.place?, loiter.radius_m?)),
        _ => None,
    });
    PlanLines {
        path: std::iter::once(legs).chain(loiters).map(line).collect(),
        fence: sides(plan).map(line).collect(),
    }
}
