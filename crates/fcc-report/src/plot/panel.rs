//! One pair of axes, and the curves between them.

use plotters::chart::ChartContext;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::axis::Axis;
use super::canvas::{Area, Drawn, FAINT, GRID, LABEL_PX, PlotError, TEXT, pen, px, text};

type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Axis, Axis>>;

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

/// One pair of axes, and the curves between them.
pub(crate) struct Panel<'a> {
    area: Area<'a>,
    chart: Chart<'a>,
    x: Axis,
    y: Axis,
    frame: Frame,
}

impl<'a> Panel<'a> {
    /// A panel in its frame; nothing is drawn yet.
    pub(crate) fn new(area: &Area<'a>, frame: Frame, x: Axis, y: Axis) -> Result<Self, PlotError> {
        let left = frame.left - Y_LABELS_PX;
        let cell = area.clone().shrink(
            (px(left), px(frame.top)),
            (
                px(frame.right - left),
                px(frame.bottom - frame.top + X_LABELS_PX),
            ),
        );
        let chart = ChartBuilder::on(&cell)
            .x_label_area_size(px(X_LABELS_PX))
            .y_label_area_size(px(Y_LABELS_PX))
            .build_cartesian_2d(x.clone(), y.clone())?;
        Ok(Self {
            area: area.clone(),
            chart,
            x,
            y,
            frame,
        })
    }

    /// Tints the whole height from one x to another.
    pub(crate) fn tint(&mut self, from: f64, to: f64, ink: RGBColor) -> Drawn {
        let (from, to) = (from.max(self.x.from), to.min(self.x.to));
        if from < to {
            let corners = [(from, self.y.from), (to, self.y.to)];
            self.chart
                .draw_series([Rectangle::new(corners, ink.filled())])?;
        }
        Ok(())
    }

    /// Draws grid and axes, with the labels of the x axis if wanted.
    pub(crate) fn axes(&mut self, with_x_labels: bool) -> Drawn {
        let label = text(LABEL_PX, TEXT, HPos::Center, VPos::Center);
        let (log, silent) = (
            !self.x.light.is_empty() || !self.y.light.is_empty(),
            |_: &f64| String::new(),
        );
        let mut mesh = self.chart.configure_mesh();
        mesh.bold_line_style(pen(GRID, 0.6))
            .light_line_style(pen(RGBColor(240, 240, 240), 0.5))
            .axis_style(pen(FAINT, 0.8))
            .label_style(label.clone())
            .axis_desc_style(label)
            .set_all_tick_mark_size(px(3.0));
        if !log {
            mesh.light_line_style(TRANSPARENT);
        }
        if !with_x_labels {
            mesh.x_label_formatter(&silent);
        }
        mesh.draw()?;
        self.titles(with_x_labels)
    }

    fn titles(&self, with_x_title: bool) -> Drawn {
        let frame = self.frame;
        if with_x_title && !self.x.title.is_empty() {
            let at = (
                px(f64::midpoint(frame.left, frame.right)),
                px(frame.bottom + X_LABELS_PX - 4.0),
            );
            let style = text(LABEL_PX, TEXT, HPos::Center, VPos::Bottom);
            self.area.draw_text(&self.x.title, &style, at)?;
        }
        if !self.y.title.is_empty() {
            let at = (
                px(frame.left - Y_LABELS_PX + 4.0),
                px(f64::midpoint(frame.top, frame.bottom)),
            );
            let style =
                text(LABEL_PX, TEXT, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
            self.area.draw_text(&self.y.title, &style, at)?;
        }
        Ok(())
    }

    /// Draws a line through points of the axes.
    pub(crate) fn polyline(&mut self, points: Vec<(f64, f64)>, style: ShapeStyle) -> Drawn {
        // A line of one point would be invisible.
        if let [(x, y)] = points.as_slice() {
            let (at, radius) = ((*x, *y), px(0.8));
            self.chart
                .draw_series([Circle::new(at, radius, style.color.filled())])?;
        } else {
            self.chart.draw_series([PathElement::new(points, style)])?;
        }
        Ok(())
    }

    /// Draws a filled rectangle between points of the axes.
    pub(crate) fn bar(&mut self, from: (f64, f64), to: (f64, f64), style: ShapeStyle) -> Drawn {
        self.chart
            .draw_series([Rectangle::new([from, to], style)])?;
        Ok(())
    }

    /// Draws a dot, filled or not.
    pub(crate) fn dot(&mut self, at: (f64, f64), radius_px: f64, style: ShapeStyle) -> Drawn {
        self.chart
            .draw_series([Circle::new(at, px(radius_px), style)])?;
        Ok(())
    }

    /// Whether the x axis contains a value.
    pub(crate) fn shows(&self, x: f64) -> bool {
        (self.x.from..=self.x.to).contains(&x)
    }

    /// Position of a point on the sheet, px.
    pub(crate) fn on_sheet(&self, at: (f64, f64)) -> (f64, f64) {
        let frame = self.frame;
        let share = |value: f64, axis: &Axis| (value - axis.from) / (axis.to - axis.from);
        (
            frame.left + share(at.0, &self.x) * (frame.right - frame.left),
            frame.bottom - share(at.1, &self.y) * (frame.bottom - frame.top),
        )
    }
}
