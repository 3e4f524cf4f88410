//! The plots of values over time.

mod panel;

use fcc_core::framework::schema::{Kind, Schema};
use fcc_core::framework::{Readings, RecordOf};
use fcc_telemetry::Telemetry;
use fcc_telemetry::schema::{Column, columns};
use fcc_telemetry::units::{SI, Shown};

use super::terms::capitalized;
use panel::Role;
pub(crate) use panel::{Curve, Ink, Moment};
pub use panel::{Panel, Scale, ValueRange};

/// Values over time in panels, one above another.
#[derive(Clone, Debug)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// From the top.
    pub panels: Vec<Panel>,
}

/// The values of a record, by name.
#[derive(Debug)]
pub struct Quantities {
    columns: Vec<Column>,
}

impl Quantities {
    pub(crate) fn of<T: Schema>() -> Self {
        Self {
            columns: columns::<T>(),
        }
    }

    /// The first number of this name in a part of the record.
    fn find<'a>(&'a self, part: &'a str, name: &str) -> Option<(usize, &'a Column)> {
        let mut numbers = self.numbers(part);
        numbers.find(|(_, column)| column.field == name)
    }

    fn numbers<'a>(&'a self, part: &'a str) -> impl Iterator<Item = (usize, &'a Column)> {
        let columns = self.columns.iter().enumerate();
        columns.filter(move |(_, column)| {
            column.kind == Kind::Number && column.path.split('.').next() == Some(part)
        })
    }

    fn taken(&self, column: &Column) -> Option<usize> {
        let path = format!("{}.taken", column.reading.as_ref()?);
        self.columns.iter().position(|column| column.path == path)
    }

    /// Measurement, estimate and set point of this name.
    pub fn panel(&self, name: &'static str, units: &[Shown]) -> Panel {
        let measured = self.find("measurements", name);
        let estimated = self.find("estimate", name);
        let desired = self.find("setpoints", name);
        let mut curves = Vec::new();
        if let Some((value, column)) = measured {
            let role = Role::Measured(self.taken(column));
            let (ink, name) = match estimated {
                Some(_) => (Ink::Measured, "measured"),
                None => (Ink::Actual, "measured"),
            };
            curves.push(Curve::new(ink, name, role, value));
        }
        if let Some((value, _)) = estimated {
            curves.push(Curve::new(Ink::Actual, "actual", Role::Estimated, value));
        }
        if let Some((value, _)) = desired {
            curves.push(Curve::new(Ink::Desired, "desired", Role::Desired, value));
        }
        let column = measured.or(estimated).or(desired);
        Panel::of(name, column.map(|(_, column)| column), units, curves)
    }

    /// An output, as `units` have it.
    pub fn output(&self, name: &'static str, units: &[Shown]) -> Panel {
        let output = self.find("outputs", name);
        let curve = |(value, _)| Curve::new(Ink::Actual, "commanded", Role::Output, value);
        let curves = output.map(curve).into_iter().collect();
        Panel::of(name, output.map(|(_, column)| column), units, curves)
    }
}

/// The plots that follow from the schema.
pub(crate) fn declared<C: Telemetry>(of: &Quantities) -> Vec<Plot> {
    let mut plots: Vec<Plot> = Vec::new();
    let mut shown: Vec<&'static str> = Vec::new();
    let mut readings: Vec<&str> = Vec::new();
    for (_, column) in of.numbers("measurements") {
        let name = column.field;
        if shown.contains(&name) {
            continue;
        }
        shown.push(name);
        let reading = column.reading.as_deref().unwrap_or(&column.path);
        let panel = of.panel(name, SI);
        if let Some(plot) = plots.last_mut()
            && readings.last() == Some(&reading)
        {
            plot.panels.push(panel);
        } else {
            readings.push(reading);
            plots.push(Plot {
                title: title_of::<C>(reading),
                caption: column.meaning.clone(),
                panels: vec![panel],
            });
        }
    }
    let estimates = of.numbers("estimate").chain(of.numbers("setpoints"));
    let mut more: Vec<&'static str> = estimates.map(|(_, column)| column.field).collect();
    more.retain(|name| !shown.contains(name));
    more.dedup();
    let outputs = of.numbers("outputs").map(|(_, column)| column.field);
    plots.extend([
        Plot {
            title: "Other estimates and set points".to_owned(),
            caption: "Values that are not measured.".to_owned(),
            panels: more.into_iter().map(|name| of.panel(name, SI)).collect(),
        },
        Plot {
            title: "Outputs".to_owned(),
            caption: "Commanded values while the loop had control.".to_owned(),
            panels: outputs.map(|name| of.output(name, SI)).collect(),
        },
    ]);
    plots.retain(|plot| !plot.panels.is_empty());
    plots
}

/// The display name of a reading at a path.
fn title_of<C: Telemetry>(path: &str) -> String {
    let mut readings: Vec<String> = Vec::new();
    for column in columns::<RecordOf<C>>() {
        if let Some(reading) = column.reading
            && !readings.contains(&reading)
        {
            readings.push(reading);
        }
    }
    let place = readings.iter().position(|reading| reading == path);
    let named = place.and_then(|place| C::Measurements::NAMES.get(place));
    let own = path.rsplit('.').next().unwrap_or(path).replace('_', " ");
    capitalized(named.copied().unwrap_or(&own))
}
