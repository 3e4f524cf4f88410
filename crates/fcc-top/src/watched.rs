//! The parts of the screen that a controller can choose.

use fcc_core::framework::{Readings, RecordOf};
use fcc_telemetry::Telemetry;
use ratatui::Frame;
use ratatui::layout::Rect;
use serde_json::{Map, Value};

use super::picture::Picture;
use super::values;

/// Draws a part of the screen.
pub type ScreenPart<C> = fn(&mut Frame<'_>, Rect, &Picture<C>);

/// A controller whose loop can be watched in a terminal. Its declared values
/// are enough; an implementation may show them differently.
pub trait Watched: Telemetry + Sized {
    /// The program that runs the loop.
    const PROGRAM: &'static str;

    /// The names of the readings, in their order, of at most 8 letters; the
    /// rest is cut off.
    const READINGS: &'static [&'static str] = <Self::Measurements as Readings>::NAMES;

    /// The parts to the left of the lateness, each with its title and relative
    /// width: by default a table of all values.
    fn parts(_record: Option<&RecordOf<Self>>) -> Vec<(String, u16, ScreenPart<Self>)> {
        vec![("Values".to_owned(), 50, values::draw)]
    }

    /// The values as JSON.
    fn values(record: &RecordOf<Self>) -> Map<String, Value> {
        values::json::<Self>(record)
    }
}
