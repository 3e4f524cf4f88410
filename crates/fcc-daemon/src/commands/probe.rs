//! `fccd probe`: what is connected to a board.

use std::fmt::Write as _;

use fcc_flight::probe::{Connected, ProbeRequest, Values, connected};

use super::failure::Failure;
use crate::cli::ProbeArgs;
use crate::exit::Exit;
use crate::output;

/// Lists what is connected, and the lines of a configuration that read it.
pub(super) fn probe(args: &ProbeArgs) -> Result<Exit, Failure> {
    if !args.root.is_dir() {
        return Err(Failure::usage(format_args!(
            "--root {}: this is no folder: give the one with the machine's files",
            args.root.display()
        )));
    }
    let request = ProbeRequest {
        live: args.live,
        spi: args.spi,
    };
    let found = connected(&args.root, request);
    Ok(if args.json {
        output::json(&found, Exit::Success)
    } else {
        output::result(text(&found), Exit::Success)
    })
}

fn text(found: &[Connected]) -> String {
    if found.is_empty() {
        return "no sensor was found: there is no I²C bus in /dev and no device in\n\
                /sys/bus/iio/devices. Switch the buses on (docs/boards.md)"
            .to_owned();
    }
    let width = |of: fn(&Connected) -> &str| {
        let lengths = found.iter().map(|one| of(one).chars().count());
        lengths.max().unwrap_or_default()
    };
    let (at, name) = (width(|one| &one.at), width(|one| &one.name));
    let usable = found.iter().filter(|one| one.entry.is_some()).count();
    let mut text = format!(
        "{usable} of {} devices found can be configured:\n\n",
        found.len()
    );
    for one in found {
        let _ = writeln!(text, "{:at$}  {:name$}  {}", one.at, one.name, one.remark);
        for line in one.values.iter().flat_map(measured) {
            let _ = writeln!(text, "    {line}");
        }
    }
    let entries: Vec<&str> = found
        .iter()
        .filter_map(|one| one.entry.as_deref())
        .collect();
    if !entries.is_empty() {
        let _ = write!(
            text,
            "\nin a configuration, the most preferred first:\n\n{}",
            entries.join("\n")
        );
    }
    text.truncate(text.trim_end().len());
    text
}

/// A line for each quantity.
fn measured(values: &Values) -> Vec<String> {
    let degps = |rates: [f64; 3]| rates.map(f64::to_degrees);
    let vectors = [
        ("specific force", values.specific_force_mps2, "m/s²"),
        ("turn rates", values.rates_radps.map(degps), "°/s"),
        ("magnetic field", values.field_ut, "µT"),
    ];
    let numbers = [
        ("static pressure", values.static_pressure_pa, "Pa"),
        (
            "differential pressure",
            values.differential_pressure_pa,
            "Pa",
        ),
        ("air temperature", values.air_temperature_k, "K"),
        ("range", values.range_m, "m"),
    ];
    let vectors = vectors.into_iter().filter_map(|(name, value, unit)| {
        let [x, y, z] = value?;
        Some(format!("{name} {x:.2}, {y:.2}, {z:.2} {unit}"))
    });
    let numbers = numbers
        .into_iter()
        .filter_map(|(name, value, unit)| Some(format!("{name} {:.2} {unit}", value?)));
    vectors.chain(numbers).collect()
}
