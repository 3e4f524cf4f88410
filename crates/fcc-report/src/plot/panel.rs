//! One pair of axes, and where its values are on a sheet.

use super::axis::Axis;
use super::sheet::{
    Anchor, Colour, Dot, FAINT, FINE_GRID, Font, GRID, Height, LABEL_PX, Place, Sheet, TEXT, px,
};

/// Position of a panel on its sheet, px from the upper left, without its axis
/// labels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

/// Room for the labels of an axis, px.
const X_LABELS_PX: f64 = 34.0;
const Y_LABELS_PX: f64 = 54.0;
/// Length of a tick, px.
const TICK_PX: f64 = 3.0;

/// One pair of axes.
pub(crate) struct Panel {
    pub(crate) frame: Frame,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

impl Panel {
    /// Where a point of the axes is on the sheet.
    pub(crate) fn place(&self, (x, y): (f64, f64)) -> Place {
        let frame = self.frame;
        let share = |value: f64, axis: &Axis| (value - axis.from) / (axis.to - axis.from);
        (
            frame.left + share(x, &self.x) * (frame.right - frame.left),
            frame.bottom - share(y, &self.y) * (frame.bottom - frame.top),
        )
    }

    /// Whether the x axis contains a value.
    pub(crate) fn shows(&self, x: f64) -> bool {
        (self.x.from..=self.x.to).contains(&x)
    }

    /// Fills the rectangle between two points of the axes.
    pub(crate) fn fill(&self, sheet: &mut Sheet, from: Place, to: Place, fill: Colour) {
        sheet.rectangle(self.place(from), self.place(to), fill);
    }

    /// Draws a line through points of the axes.
    pub(crate) fn line(&self, sheet: &mut Sheet, points: &[Place], ink: Colour, width_px: f64) {
        let places: Vec<Place> = points.iter().map(|point| self.place(*point)).collect();
        sheet.line(&places, ink, width_px);
    }

    /// Draws a dot at a point of the axes.
    pub(crate) fn dot(&self, sheet: &mut Sheet, at: Place, radius_px: f64, dot: Dot) {
        sheet.dot(self.place(at), radius_px, dot);
    }

    /// Draws both axes with their grids; the label of the x axis if they are
    /// wanted. `zoom` are attributes for the page's script.
    pub(crate) fn axes(&self, sheet: &mut Sheet, with_x_labels: bool, zoom: &str) {
        let (x, y) = (&self.x, &self.y);
        for (places, ink) in [(&x.light, FINE_GRID), (&Self::places(x), GRID)] {
            for at in places {
                self.line(sheet, &[(*at, y.from), (*at, y.to)], ink, 0.6);
            }
        }
        for at in &y.light {
            self.line(sheet, &[(x.from, *at), (x.to, *at)], FINE_GRID, 0.6);
        }
        sheet.raw(format_args!("<g class=\"values\"{zoom}>"));
        self.y_ticks(sheet);
        sheet.raw(format_args!("</g>"));
        self.y_axis(sheet);
        self.x_axis(sheet, with_x_labels);
    }

    fn places(axis: &Axis) -> Vec<f64> {
        axis.ticks.iter().map(|(at, _)| *at).collect()
    }

    /// For each tick a line of the grid, the tick and its label, in this order.
    fn y_ticks(&self, sheet: &mut Sheet) {
        let left = self.frame.left;
        for (at, label) in &self.y.ticks {
            self.line(sheet, &[(self.x.from, *at), (self.x.to, *at)], GRID, 0.6);
            let (_, y) = self.place((self.x.from, *at));
            sheet.line(&[(left - TICK_PX, y), (left, y)], FAINT, 0.8);
            let font = Font(LABEL_PX, TEXT, Anchor::End, Height::Middle);
            sheet.text((left - 6.0, y), label, font);
        }
    }

    fn y_axis(&self, sheet: &mut Sheet) {
        let Frame {
            left, top, bottom, ..
        } = self.frame;
        sheet.line(&[(left, top), (left, bottom)], FAINT, 0.8);
        if !self.y.title.is_empty() {
            let (x, y) = (left - Y_LABELS_PX + 4.0, f64::midpoint(top, bottom));
            let turned = format!("rotate(270, {}, {})", px(x), px(y));
            let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Top);
            sheet.transformed_text((x, y), &self.y.title, font, "", &turned);
        }
    }

    fn x_axis(&self, sheet: &mut Sheet, with_labels: bool) {
        let Frame {
            left,
            right,
            bottom,
            ..
        } = self.frame;
        sheet.line(&[(left, bottom), (right, bottom)], FAINT, 0.8);
        for (at, label) in &self.x.ticks {
            let (x, _) = self.place((*at, self.y.from));
            sheet.line(&[(x, bottom), (x, bottom + TICK_PX)], FAINT, 0.8);
            if with_labels {
                let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Top);
                sheet.text((x, bottom + 6.0), label, font);
            }
        }
        if with_labels {
            let at = (f64::midpoint(left, right), bottom + X_LABELS_PX - 4.0);
            let font = Font(LABEL_PX, TEXT, Anchor::Middle, Height::Bottom);
            sheet.text(at, &self.x.title, font);
        }
    }
}
