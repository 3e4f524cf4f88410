//! The values of a record: measured, desired, commanded.

use fcc_core::framework::schema::{Kind, Value, unit};
use fcc_core::framework::{RecordOf, State};
use fcc_telemetry::Telemetry;
use fcc_telemetry::schema::{Column, Leaves, columns};
use fcc_telemetry::units::{SI, Shown};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Stylize;
use ratatui::text::Line;
use ratatui::widgets::Paragraph;
use serde_json::{Map, Value as Json};

use super::picture::Picture;

/// Characters of a quantity's name.
const NAME_WIDTH: usize = 16;

/// Draws a row for each measured, estimated, desired or commanded number.
pub(super) fn draw<C: Telemetry>(frame: &mut Frame<'_>, area: Rect, picture: &Picture<C>) {
    let Some(record) = &picture.record else {
        return;
    };
    let heading = format!("{:<NAME_WIDTH$}{:>10}{:>12}", "", "actual", "desired");
    let mut lines = vec![Line::from(heading.dim())];
    lines.extend(rows::<C>(record).iter().map(Row::line));
    frame.render_widget(Paragraph::new(lines), area);
}

/// The same as JSON, with the unit in each name.
pub(super) fn json<C: Telemetry>(record: &RecordOf<C>) -> Map<String, Json> {
    let rows = rows::<C>(record);
    let group = |of: fn(&Row) -> Option<f64>, is_output: bool| -> Json {
        let rows = rows.iter().filter(|row| row.is_output == is_output);
        rows.filter_map(|row| Some((row.field.to_owned(), of(row)?.into())))
            .collect::<Map<_, _>>()
            .into()
    };
    let mut all = Map::new();
    all.insert("actual".to_owned(), group(|row| row.actual, false));
    all.insert("setpoints".to_owned(), group(|row| row.desired, false));
    all.insert("outputs".to_owned(), group(|row| row.actual, true));
    all
}

/// One quantity, as recorded.
struct Row {
    field: &'static str,
    quantity: String,
    shown: Shown,
    actual: Option<f64>,
    desired: Option<f64>,
    is_output: bool,
}

impl Row {
    fn line(&self) -> Line<'static> {
        let Shown { unit, scale, .. } = self.shown;
        let number = |value: Option<f64>| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{:.2}", value * scale))
        };
        let desired = if self.is_output {
            "".into()
        } else {
            format!(" → {:>9}", number(self.desired)).into()
        };
        Line::from(vec![
            format!("{:<NAME_WIDTH$}", self.quantity).dim(),
            format!("{:>10}", number(self.actual)).bold(),
            desired,
            format!(" {unit}").dim(),
        ])
    }
}

/// The measured values, each with the estimate and the set point of its name,
/// then values without a measurement, and the outputs.
fn rows<C: Telemetry>(record: &RecordOf<C>) -> Vec<Row> {
    let mut leaves = Leaves::default();
    leaves.take(record);
    let values = leaves.as_slice();
    let columns = columns::<RecordOf<C>>();
    let is_never = |column: &Column| {
        let taken = column.reading.as_ref().map(|path| format!("{path}.taken"));
        let mut all = columns.iter().zip(values);
        all.any(|(other, value)| Some(&other.path) == taken.as_ref() && value.is_never())
    };
    let mut rows: Vec<Row> = Vec::new();
    for (column, value) in columns.iter().zip(values) {
        let (Value::Number(number), Kind::Number) = (value, column.kind) else {
            continue;
        };
        let part = column.path.split('.').next().unwrap_or_default();
        let is_output = part == "outputs";
        let known = match part {
            "measurements" => !is_never(column),
            "setpoints" => record.state == State::Engaged,
            "outputs" => record.sent,
            "estimate" => true,
            _ => continue,
        };
        let number = Some(*number).filter(|number| known && number.is_finite());
        let same = rows
            .iter_mut()
            .find(|row| row.field == column.field && row.is_output == is_output);
        match (part, same) {
            ("setpoints", Some(row)) => row.desired = number,
            // Of two measurements of one name, the first.
            ("measurements", Some(_)) => {}
            (_, Some(row)) => row.actual = number,
            (_, None) => {
                let is_desired = part == "setpoints";
                rows.push(Row {
                    field: column.field,
                    quantity: unit::of(column.field).quantity.replace('_', " "),
                    shown: Shown::of(column, SI),
                    actual: number.filter(|_| !is_desired),
                    desired: number.filter(|_| is_desired),
                    is_output,
                });
            }
        }
    }
    rows
}
