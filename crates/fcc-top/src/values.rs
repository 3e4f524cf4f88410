//! The values of a record: measured, desired, commanded.

use fcc_core::framework::schema::{Kind, Value, unit};
use fcc_core::framework::{RecordOf, State};
use fcc_telemetry::schema::Leaves;
use fcc_telemetry::units::{SI, Shown};
use fcc_telemetry::{RecordedQuantity, Telemetry};
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

/// The quantities of a record; the estimate is preferred to the measurement.
fn rows<C: Telemetry>(record: &RecordOf<C>) -> Vec<Row> {
    let mut leaves = Leaves::default();
    leaves.take(record);
    let values = leaves.as_slice();
    let number = |place: Option<usize>, is_known: bool| match values.get(place?) {
        Some(Value::Number(number)) => Some(*number).filter(|n| is_known && n.is_finite()),
        _ => None,
    };
    let row = |of: RecordedQuantity| {
        let taken = of.taken.and_then(|place| values.get(place));
        let measured = number(of.measured, !taken.is_some_and(|taken| taken.is_never()));
        let is_output = of.commanded.is_some();
        Row {
            field: of.column.field,
            quantity: unit::of(of.column.field).quantity.replace('_', " "),
            shown: Shown::of(&of.column, SI),
            actual: match of.estimated {
                _ if is_output => number(of.commanded, record.sent),
                None => measured,
                estimated => number(estimated, true),
            },
            desired: number(of.desired, record.state == State::Engaged),
            is_output,
        }
    };
    let all = RecordedQuantity::all::<RecordOf<C>>().into_iter();
    let numbers = all.filter(|of| of.column.kind == Kind::Number);
    numbers.map(row).collect()
}
