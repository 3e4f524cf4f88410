//! The parts of a report that a controller can choose.

use std::fmt::Debug;

use comfy_table::Table;
use fcc_core::framework::{EventOf, RecordOf};
use fcc_telemetry::Telemetry;
use serde::Serialize;

use super::plot::figure::Figure;
use super::plots::{Plot, Quantities, declared};
use super::report::RunReport;
use super::terms::Terms;

/// A controller whose recordings can be reported on. Its declared values are
/// enough; an implementation may choose other plots and terms, and add results.
pub trait Reported: Telemetry + Sized {
    /// Additional results; `()` for none.
    type Addition: Addition;

    /// Terms for the recorded loop.
    const TERMS: Terms = Terms {
        run: "run",
        plant: "Plant",
        controller: "controller",
    };

    /// Whether the report has a table of the values' ranges.
    const TABLE_OF_VALUES: bool = true;

    /// Takes a record for the additional results; times ascend.
    fn take(_addition: &mut Self::Addition, _record: &RecordOf<Self>, _time_s: f64) {}

    /// Takes an event for the additional results.
    fn take_event(_addition: &mut Self::Addition, _event: &EventOf<Self>) {}

    /// The plots of values over time: by default one per reading, with the
    /// estimates and set points of the same name, and one for the outputs.
    fn plots(of: &Quantities) -> Vec<Plot> {
        declared::<Self>(of)
    }
}

/// Additional results for one kind of plant. Serialized, they are keys of the
/// report.
pub trait Addition: Clone + Debug + Serialize {
    /// The last record was taken.
    fn finish(&mut self) {}

    /// Sentences for the summary.
    fn findings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Figures, below those over time.
    fn figures(&self, _run: &RunReport) -> Vec<Figure> {
        Vec::new()
    }

    /// Its tables as text.
    fn text(&self) -> String {
        String::new()
    }

    /// Its tables for the page, each with a title and a caption.
    fn tables(&self) -> Vec<(&'static str, &'static str, Table)> {
        Vec::new()
    }
}

/// No additional results.
impl Addition for () {}
