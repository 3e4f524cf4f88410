//! Navigation by other methods than the one that was flown, from the raw readings
//! of a recording: how far each is from what was flown and from what sensors
//! measured, and its innovations against their bounds.

mod method;
mod quantities;

use std::fmt::Write as _;

use fcc_core::framework::RecordOf;
use fcc_fixed_wing::Autopilot;
use fcc_navigation::inertial::RawNavigationConfig;
use serde::Serialize;

use crate::plot::{Detail, Figure, figure};
use crate::report::RunReport;
use crate::table::table;
use method::MethodRun;
pub use method::{Difference, MethodResult, SourceConsistency};

/// Runs the raw readings of a recorded flight through navigation.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(transparent)]
pub struct NavigationReplay {
    /// One for each method; complete once the recording has been read.
    pub results: Vec<MethodResult>,
    #[serde(skip)]
    runs: Vec<MethodRun>,
}

impl NavigationReplay {
    /// By these methods, in this order.
    pub fn new(methods: impl IntoIterator<Item = RawNavigationConfig>) -> Self {
        Self {
            results: Vec::new(),
            runs: methods.into_iter().map(MethodRun::new).collect(),
        }
    }

    /// Whether the recording had raw inertial readings.
    pub fn has_readings(&self) -> bool {
        self.runs.iter().any(MethodRun::has_readings)
    }

    pub(super) fn take(&mut self, record: &RecordOf<Autopilot>, time_s: f64) {
        for run in &mut self.runs {
            run.take(record, time_s);
        }
    }

    pub(super) fn finish(&mut self) {
        self.results = self.runs.iter().map(MethodRun::result).collect();
    }

    /// A plot of each quantity with all methods, and one of each source's
    /// innovations.
    pub(super) fn figures(&self, run: &RunReport) -> Vec<Figure> {
        let quantities = (0..quantities::ALL.len()).map(|at| {
            let panels = self.runs.iter().filter_map(|run| run.panel(at));
            quantities::plot(at, panels.collect())
        });
        let innovations = self.runs.iter().flat_map(MethodRun::innovation_plots);
        let plots = quantities.chain(innovations);
        plots
            .filter(|plot| !plot.panels.is_empty())
            .map(|plot| figure(run, &plot, Detail::None))
            .collect()
    }

    /// The results as tables.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for result in &self.results {
            let mut differences = table(&[result.method, "from measured", "from flown", "ticks"]);
            for of in &result.differences {
                let number = |rms: Option<f64>| {
                    rms.map_or_else(|| "-".to_owned(), |rms| format!("{rms:.2}"))
                };
                differences.add_row([
                    format!("{}, {}", of.quantity, of.unit),
                    number(of.rms_from_measured),
                    number(of.rms_from_flown),
                    of.ticks_from_measured.max(of.ticks_from_flown).to_string(),
                ]);
            }
            let _ = writeln!(text, "RMS differences\n{differences}\n");
            if result.innovations.is_empty() {
                continue;
            }
            let mut innovations = table(&["source", "innovations", "refused", "RMS over sigma"]);
            for of in &result.innovations {
                innovations.add_row([
                    of.source.to_owned(),
                    of.count.to_string(),
                    of.refused.to_string(),
                    format!("{:.2}", of.rms_accepted),
                ]);
            }
            let _ = writeln!(text, "{innovations}\n");
        }
        text.push_str(
            "from measured: what sensors of the quantity itself gave beside; from flown: the \
             estimate while the loop had control. RMS over sigma: of those that were not refused; \
             consistent ones have at most 1.",
        );
        text
    }
}
