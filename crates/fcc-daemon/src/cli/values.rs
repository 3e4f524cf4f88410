//! Values of options, as they are typed.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser};
use fcc_flight::calibrate::{CalibrationKind, HandlingFault};
use fcc_flight::config::{EarlyWakeChoice, GustsChoice};

pub(super) fn gusts() -> impl TypedValueParser<Value = GustsChoice> {
    PossibleValuesParser::new(GustsChoice::ALL.map(|(name, _)| name)).try_map(|given| {
        GustsChoice::ALL
            .into_iter()
            .find_map(|(name, choice)| (name == given).then_some(choice))
            .ok_or("unknown strength")
    })
}

pub(super) fn calibration_kind() -> impl TypedValueParser<Value = CalibrationKind> {
    PossibleValuesParser::new(CalibrationKind::ALL.map(CalibrationKind::name)).try_map(|given| {
        let mut all = CalibrationKind::ALL.into_iter();
        all.find(|kind| kind.name() == given).ok_or("unknown kind")
    })
}

pub(super) fn handling_fault() -> impl TypedValueParser<Value = HandlingFault> {
    const FAULTS: [(&str, HandlingFault); 4] = [
        ("ends-early", HandlingFault::EndsEarly),
        ("restless", HandlingFault::Restless),
        ("magnet", HandlingFault::Magnet),
        ("one-axis", HandlingFault::OneAxis),
    ];
    PossibleValuesParser::new(FAULTS.map(|(name, _)| name)).try_map(|given| {
        let found = FAULTS.into_iter().find(|(name, _)| *name == given);
        found.map(|(_, fault)| fault).ok_or("unknown fault")
    })
}

pub(super) fn early_wake() -> impl TypedValueParser<Value = EarlyWakeChoice> {
    PossibleValuesParser::new(["auto", "on", "off"]).map(|given| match given.as_str() {
        "on" => EarlyWakeChoice::On,
        "off" => EarlyWakeChoice::Off,
        _ => EarlyWakeChoice::Auto,
    })
}

/// The name of a file or a folder to write.
pub(super) fn output() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if path == Path::new("-") {
            return Err("standard output is for the result: give a name, or ./- for one called -");
        }
        Ok(path)
    })
}

pub(super) fn positive_seconds(text: &str) -> Result<f64, String> {
    number_within(text, 0.1, 1e6, "seconds")
}

pub(super) fn margin_us(text: &str) -> Result<f64, String> {
    number_within(text, 1.0, 10_000.0, "µs")
}

pub(super) fn cpu_cap_percent(text: &str) -> Result<f64, String> {
    number_within(text, 0.0, 50.0, "percent")
}

pub(super) fn rate_hz(text: &str) -> Result<f64, String> {
    number_within(text, 1.0, 2_000.0, "Hz")
}

/// A number, of which the daemon says whether the aircraft permits it.
pub(super) fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "give a number".to_owned())
}

pub(super) fn number_within(text: &str, least: f64, most: f64, unit: &str) -> Result<f64, String> {
    text.parse::<f64>()
        .ok()
        .filter(|number| (least..=most).contains(number))
        .ok_or_else(|| format!("give {least} to {most} {unit}"))
}
