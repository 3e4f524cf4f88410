//! `fccd plan`: checks, shows and converts flight plans.

use std::fmt::Write as _;
use std::path::Path;

use fcc_flight::config::{BuiltInSection, Config};
use fcc_plan::{FileError, Format, Plan, Problem};
use fcc_report::{plan_page, plan_table};
use serde::Serialize;

use super::failure::Failure;
use super::plan_picture::{fence, over_ground, places, rows, zones};
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
        let checked = check_file(path, &config);
        if !checked.ok {
            exit = Exit::Usage;
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
            let _ = write!(text, "\n{file}: remark: {remark}");
        }
        return output::result(text, exit);
    }
    for problem in &checked.problems {
        output::message(format_args!("{file}: {problem}"));
    }
    exit
}

fn check_file(path: &Path, config: &Config) -> Checked {
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
        Err(FileError::Invalid { problems, .. }) => return unread(problems),
        Err(error) => {
            let error = error.to_string();
            let message = error.strip_prefix(&format!("{file}: ")).unwrap_or(&error);
            let problem = Problem::of("", message);
            return unread(vec![problem]);
        }
    };
    let (plan, problems) = match config.checked_plan(&plan) {
        Ok(flown) => (flown, Vec::new()),
        Err(problems) => (plan, problems),
    };
    let remarks = if problems.is_empty() {
        config.plan_remarks(&plan)
    } else {
        Vec::new()
    };
    Checked {
        file,
        remarks,
        ok: problems.is_empty(),
        sha256: Some(plan.hash().to_string()),
        items: plan.items.len(),
        problems,
    }
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
    let table = match rows.as_slice() {
        [] => String::new(),
        rows => format!("\n{}", plan_table(rows)),
    };
    let mut written = zones(&plan);
    if let Some(out) = &args.html {
        let title = format!("{name}, {hash:.12}");
        let config = configuration(args.config.as_deref())?;
        let invalid =
            |problem: Problem| Failure::of(Exit::Usage, format_args!("{name}: {problem}"));
        let (flown, ground) = config
            .with_ground(&plan, |terrain| over_ground(&plan, terrain))
            .map_err(invalid)?;
        let page = plan_page(&title, &rows, &places(&flown), &fence(&plan), &ground);
        if fcc_plan::read_file(out).is_ok() {
            return Err(Failure::new(format_args!(
                "{}: it is a flight plan, which no page replaces: choose another name",
                out.display()
            )));
        }
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
        "{name}: {} items, {hash:.12}{table}{written}",
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
    fcc_plan::read_file(path).map_err(|error| Failure::of(Exit::Usage, error))
}

/// Writes a file that is not the plan itself.
fn write(out: &Path, plan: &Path, text: &str) -> Result<(), Failure> {
    let failed = |error| {
        Failure::new(format_args!(
            "{}: cannot be written: {error}",
            out.display()
        ))
    };
    fcc_record::write_plan(out, &[plan], text.as_bytes()).map_err(failed)
}
