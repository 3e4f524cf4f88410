//! The canvas of the plots, and its colours.

use std::io;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A plot could not be drawn.
#[derive(thiserror::Error, Debug)]
#[error("a plot could not be drawn: {0}")]
pub struct PlotError(#[from] DrawingAreaErrorKind<io::Error>);

pub(crate) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type Drawn = Result<(), PlotError>;

/// Width of every plot, px: half a millimetre of an A4 page is about 2 px.
pub(crate) const WIDTH_PX: f64 = 760.0;

/// The library rounds to whole units; at this many units per pixel, lines are
/// smooth.
const UNITS_PER_PX: f64 = 10.0;

/// Actual values.
pub(crate) const ACTUAL: RGBColor = RGBColor(24, 66, 110);
/// Measurements, behind the estimates.
pub(crate) const MEASURED: RGBColor = RGBColor(150, 178, 206);
/// Desired values. Only these have this colour: it selects the dashed lines.
pub(crate) const DESIRED: RGBColor = RGBColor(200, 80, 30);
/// Values to compare with.
pub(crate) const OTHER: RGBColor = RGBColor(120, 120, 120);
/// Axes and their labels.
pub(crate) const TEXT: RGBColor = RGBColor(45, 45, 45);
/// Less prominent than the text.
pub(crate) const FAINT: RGBColor = RGBColor(130, 130, 130);
/// The grid.
pub(crate) const GRID: RGBColor = RGBColor(224, 224, 224);

/// Text sizes, px.
pub(crate) const LABEL_PX: f64 = 10.5;
pub(crate) const SMALL_PX: f64 = 9.0;

/// Pixels in the library's units.
pub(crate) fn px(pixels: f64) -> i32 {
    (pixels * UNITS_PER_PX).round() as i32
}

/// A pen of a width in px.
pub(crate) fn pen(ink: RGBColor, width_px: f64) -> ShapeStyle {
    ink.stroke_width(px(width_px) as u32)
}

/// Text of a size in px, at its anchor.
pub(crate) fn text(size_px: f64, ink: RGBColor, h: HPos, v: VPos) -> TextStyle<'static> {
    // The library divides text sizes by this factor.
    const LIBRARY_FACTOR: f64 = 1.24;
    let size = size_px * UNITS_PER_PX * LIBRARY_FACTOR;
    let mut style = TextStyle::from(("sans-serif", size).into_font()).pos(Pos::new(h, v));
    style.color = ink.to_backend_color();
    style
}

/// Approximate width of a text, px: sans-serif letters are half as wide as
/// high.
pub(crate) fn text_width_px(text: &str, size_px: f64) -> f64 {
    0.52 * size_px * text.chars().count() as f64
}

/// A colour in the notation of SVG.
pub(crate) fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The symbol before a text of a legend.
pub(crate) enum Sample {
    /// A line.
    Line(ShapeStyle),
    /// A short upright line.
    Upright(ShapeStyle),
    /// A dot, filled or not.
    Dot(ShapeStyle),
    /// A tint.
    Block(RGBColor),
}

/// Draws a legend: lines, dots and tints, in a row.
pub(crate) fn legend<'a>(
    area: &Area<'_>,
    left_px: f64,
    middle_px: f64,
    entries: impl IntoIterator<Item = (Sample, &'a str)>,
) -> Drawn {
    let style = text(LABEL_PX, TEXT, HPos::Left, VPos::Center);
    let mut left = left_px;
    for (sample, label) in entries {
        let at = |x: f64, y: f64| (px(left + x), px(middle_px + y));
        match sample {
            Sample::Line(pen) => area.draw(&PathElement::new([at(0.0, 0.0), at(21.0, 0.0)], pen)),
            Sample::Upright(pen) => {
                area.draw(&PathElement::new([at(12.0, -5.0), at(12.0, 5.0)], pen))
            }
            Sample::Dot(style) => area.draw(&Circle::new(at(12.0, 0.0), px(3.0), style)),
            Sample::Block(tint) => area.draw(&Rectangle::new(
                [at(5.0, -5.0), at(21.0, 5.0)],
                tint.filled(),
            )),
        }?;
        area.draw_text(label, &style, at(26.0, 0.0))?;
        left += 42.0 + text_width_px(label, LABEL_PX);
    }
    Ok(())
}

/// Draws a plot of this height; `label` describes it for screen readers.
pub(crate) fn draw(
    height_px: f64,
    label: &str,
    paint: impl FnOnce(&Area<'_>) -> Drawn,
) -> Result<String, PlotError> {
    let mut svg = String::new();
    {
        let size = (px(WIDTH_PX) as u32, px(height_px) as u32);
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        paint(&area)?;
        area.present().map_err(PlotError::from)?;
    }
    Ok(finish(&svg, height_px, label))
}

/// Adds what the library cannot express: a width relative to the page, one font
/// for all, dashes for desired values. (The library draws each dash as an
/// element: megabytes for a long line.)
fn finish(svg: &str, height_px: f64, label: &str) -> String {
    let body = svg.split_once('>').map_or("", |(_, body)| body);
    let desired = format!("stroke=\"{}\"", hex(DESIRED));
    let dashed = format!("{desired} stroke-dasharray=\"{} {}\"", px(5.0), px(3.0));
    let body = body
        .replace("font-family=\"sans-serif\" ", "")
        .replace("opacity=\"1\" ", "")
        .replace(&desired, &dashed);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" role=\"img\" \
         aria-label=\"{label}\" font-family=\"Helvetica Neue, Helvetica, Arial, \
         Liberation Sans, sans-serif\" stroke-linejoin=\"round\">{body}",
        px(WIDTH_PX),
        px(height_px)
    )
}
