//! The plots of values over time.

mod panel;

use fcc_core::framework::schema::Schema;
use fcc_core::framework::{Readings, RecordOf};
use fcc_telemetry::schema::columns;
use fcc_telemetry::units::{SI, Shown};
use fcc_telemetry::{RecordedQuantity, Telemetry};

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

/// The quantities of a record, by name.
#[derive(Debug)]
pub struct Quantities(Vec<RecordedQuantity>);

impl Quantities {
    pub(crate) fn of<T: Schema>() -> Self {
        Self(RecordedQuantity::all::<T>())
    }

    fn find(&self, name: &str, is_output: bool) -> Option<&RecordedQuantity> {
        let mut all = self.0.iter();
        all.find(|of| of.column.field == name && of.commanded.is_some() == is_output)
    }

    /// Measurement, estimate and set point of this name.
    pub fn panel(&self, name: &'static str, units: &[Shown]) -> Panel {
        let found = self.find(name, false);
        let mut curves = Vec::new();
        if let Some(value) = found.and_then(|of| of.measured) {
            let ink = match found.and_then(|of| of.estimated) {
                Some(_) => Ink::Measured,
                None => Ink::Actual,
            };
            let role = Role::Measured(found.and_then(|of| of.taken));
            curves.push(Curve::new(ink, "measured", role, value));
        }
        if let Some(value) = found.and_then(|of| of.estimated) {
            curves.push(Curve::new(Ink::Actual, "estimated", Role::Estimated, value));
        }
        if let Some(value) = found.and_then(|of| of.desired) {
            curves.push(Curve::new(Ink::Desired, "desired", Role::Desired, value));
        }
        Panel::of(name, found.map(|of| &of.column), units, curves)
    }

    /// An output, as `units` have it.
    pub fn output(&self, name: &'static str, units: &[Shown]) -> Panel {
        let found = self.find(name, true);
        let curve = |value| Curve::new(Ink::Actual, "commanded", Role::Output, value);
        let curves = found.and_then(|of| of.commanded).map(curve);
        let curves = curves.into_iter().collect();
        Panel::of(name, found.map(|of| &of.column), units, curves)
    }
}

/// The plots that follow from the schema.
pub(crate) fn declared<C: Telemetry>(of: &Quantities) -> Vec<Plot> {
    let mut plots: Vec<Plot> = Vec::new();
    let mut readings: Vec<&str> = Vec::new();
    for RecordedQuantity { column, .. } in of.0.iter().filter(|of| of.measured.is_some()) {
        let reading = column.reading.as_deref().unwrap_or(&column.path);
        let panel = of.panel(column.field, SI);
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
    let others = of.0.iter().filter(|of| of.measured.is_none());
    let (outputs, more): (Vec<_>, Vec<_>) = others.partition(|of| of.commanded.is_some());
    let panels = |all: Vec<&RecordedQuantity>, panel: fn(&Quantities, _, _) -> Panel| {
        let panels = all.into_iter().map(|one| panel(of, one.column.field, SI));
        panels.collect()
    };
    plots.extend([
        Plot {
            title: "Other estimates and set points".to_owned(),
            caption: "Values that are not measured.".to_owned(),
            panels: panels(more, Quantities::panel),
        },
        Plot {
            title: "Outputs".to_owned(),
            caption: "Commanded values while the loop had control.".to_owned(),
            panels: panels(outputs, Quantities::output),
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

#[cfg(all(test, feature = "flight"))]
mod tests {
    use fcc_fixed_wing::Autopilot;

    use super::*;

    /// proto/layout.md: 0 none, 1 hold, 2 timed pattern, 3 plan, 4 loiter, 5 go-to,
    /// 6 return, 7 take-off, 8 land, 9 go-around, 10 glide.
    #[test]
    fn a_mode_is_plotted_by_its_names() {
        let plots = declared::<Autopilot>(&Quantities::of::<RecordOf<Autopilot>>());
        let mut panels = plots.iter().flat_map(|plot| &plot.panels);
        let mode = panels.find(|panel| panel.title() == "mode").unwrap();
        let names = [
            "none",
            "hold",
            "timed pattern",
            "plan",
            "loiter",
            "go to",
            "return",
            "takeoff",
            "land",
            "go around",
            "glide",
        ];
        assert_eq!(mode.labels(), names);
    }
}
