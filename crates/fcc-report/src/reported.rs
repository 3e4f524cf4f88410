//! What a controller's reports have beside what every loop's report has.

use std::fmt::Debug;

use comfy_table::Table;
use fcc_core::framework::RecordOf;
use fcc_telemetry::Telemetry;
use serde::Serialize;

use super::plot::Figure;
use super::plots::{Plot, Quantities, declared};
use super::report::RunReport;
use super::words::Words;

/// A controller whose recordings can be reported on. What is declared of its
/// values is enough; an implementation may choose other plots and words, and add
/// results of its own.
pub trait Reported: Telemetry + Sized {
    /// Results of its own; `()` for none.
    type Addition: Addition;

    /// The words for what was recorded.
    const WORDS: Words = Words {
        run: "run",
        plant: "Plant",
        controller: "controller",
    };

    /// Whether the report has a table of what its values ranged over.
    const TABLE_OF_VALUES: bool = true;

    /// Takes a record for the results of its own; times ascend.
    fn take(_addition: &mut Self::Addition, _record: &RecordOf<Self>, _time_s: f64) {}

    /// The plots of its values over time: by default one for each reading, with
    /// the estimates and set points of the same name, and one for the outputs.
    fn plots(of: &Quantities) -> Vec<Plot> {
        declared::<Self>(of)
    }
}

/// Results that only one kind of plant has. Serialized, they are keys of the
/// report.
pub trait Addition: Clone + Debug + Serialize {
    /// There are no more records.
    fn finish(&mut self) {}

    /// What is worth saying in words.
    fn findings(&self) -> Vec<String> {
        Vec::new()
    }

    /// Its figures, below those over time.
    fn figures(&self, _run: &RunReport) -> Vec<Figure> {
        Vec::new()
    }

    /// Its tables as text.
    fn text(&self) -> String {
        String::new()
    }

    /// Its tables on a page, each with a title and how to read it.
    fn tables(&self) -> Vec<(&'static str, &'static str, Table)> {
        Vec::new()
    }
}

/// No results but those of every loop.
impl Addition for () {}
