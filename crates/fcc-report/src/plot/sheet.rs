//! The sheet that a plot is drawn on: SVG, which stands inside a page and prints
//! as it is.

use std::fmt::Write as _;

use maud::html;

/// Width of every plot, px: half a millimetre of an A4 page is about 2 px.
pub(crate) const WIDTH_PX: f64 = 760.0;

/// A colour, as SVG writes it. The page has another for a dark screen for each.
pub(crate) type Colour = &'static str;

/// What is actual.
pub(crate) const ACTUAL: Colour = "#18426E";
/// Measurements, behind the estimates.
pub(crate) const MEASURED: Colour = "#96B2CE";
/// What is desired: the only lines that are dashed.
pub(crate) const DESIRED: Colour = "#C8501E";
/// What is compared with.
pub(crate) const OTHER: Colour = "#787878";
/// Axes and their labels.
pub(crate) const TEXT: Colour = "#2D2D2D";
/// Less than that.
pub(crate) const FAINT: Colour = "#828282";
/// The grid.
pub(crate) const GRID: Colour = "#E0E0E0";
pub(crate) const FINE_GRID: Colour = "#F0F0F0";
/// Where events are.
pub(crate) const MARK: Colour = "#BEBEBE";
pub(crate) const WHITE: Colour = "#FFFFFF";

/// Text sizes, px.
pub(crate) const LABEL_PX: f64 = 10.5;
pub(crate) const SMALL_PX: f64 = 9.0;

/// Pixels in the units of a sheet: tenths, so that whole numbers are enough.
pub(crate) fn px(pixels: f64) -> i32 {
    (pixels * 10.0).round() as i32
}

/// Approximate width of a text, px: sans-serif letters are half as wide as
/// high.
pub(crate) fn text_width_px(text: &str, size_px: f64) -> f64 {
    0.52 * size_px * text.chars().count() as f64
}

/// Which end of a text its place is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// What of a text is at the height of its place.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Height {
    Top,
    Middle,
    Bottom,
}

/// A text's colour, size and place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Font(
    pub(crate) f64,
    pub(crate) Colour,
    pub(crate) Anchor,
    pub(crate) Height,
);

/// How a dot is drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Dot {
    Filled(Colour),
    /// With a line of this width, px.
    Open(Colour, f64),
}

/// The symbol before a text of a legend.
pub(crate) enum Sample {
    Line(Colour, f64),
    /// A short upright line.
    Upright(Colour, f64),
    Dot(Dot),
    /// A tint.
    Block(Colour),
}

/// A place on a sheet, px from its upper left.
pub(crate) type Place = (f64, f64);

/// A plot in the making.
#[derive(Default)]
pub(crate) struct Sheet {
    svg: String,
}

impl Sheet {
    /// A line through places.
    pub(crate) fn line(&mut self, places: &[Place], colour: Colour, width_px: f64) {
        let dashes = if colour == DESIRED {
            " stroke-dasharray=\"50 30\""
        } else {
            ""
        };
        let points = places.iter().map(|(x, y)| format!("{},{}", px(*x), px(*y)));
        let points: Vec<String> = points.collect();
        let (points, width) = (points.join(" "), px(width_px));
        self.raw(format_args!(
            "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes} \
             points=\"{points}\"/>"
        ));
    }

    /// A filled rectangle between two corners.
    pub(crate) fn rectangle(&mut self, (x, y): Place, (right, bottom): Place, fill: Colour) {
        let (left, top) = (px(x.min(right)), px(y.min(bottom)));
        let (width, height) = (px(x.max(right)) - left, px(y.max(bottom)) - top);
        self.raw(format_args!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" \
             fill=\"{fill}\"/>"
        ));
    }

    pub(crate) fn dot(&mut self, (x, y): Place, radius_px: f64, dot: Dot) {
        let (x, y, radius) = (px(x), px(y), px(radius_px));
        let style = match dot {
            Dot::Filled(colour) => format!("fill=\"{colour}\""),
            Dot::Open(colour, width_px) => {
                let width = px(width_px);
                format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"")
            }
        };
        self.raw(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {style}/>"
        ));
    }

    /// Text at a place.
    pub(crate) fn text(&mut self, place: Place, text: &str, font: Font) {
        self.transformed_text(place, text, font, "", "");
    }

    /// Text at a place, with a class and a transformation.
    pub(crate) fn transformed_text(
        &mut self,
        (x, y): Place,
        text: &str,
        Font(size_px, colour, anchor, height): Font,
        class: &str,
        transform: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let dy = match height {
            Height::Top => "0.76em",
            Height::Middle => "0.5ex",
            Height::Bottom => "-0.5ex",
        };
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let text = html! {
            text class=[some(class)] x=(px(x)) y=(px(y)) dy=(dy) text-anchor=(anchor)
                font-size=(px(size_px)) fill=(colour) transform=[some(transform)]
                { (text) }
        };
        self.raw(format_args!("{}", text.into_string()));
    }

    /// An element.
    pub(crate) fn raw(&mut self, element: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.svg, "{element}");
    }

    /// What lines, dots and tints mean, in a row.
    pub(crate) fn legend<'a>(
        &mut self,
        (left_px, y): Place,
        entries: impl IntoIterator<Item = (Sample, &'a str)>,
    ) {
        let mut x = left_px;
        for (sample, text) in entries {
            match sample {
                Sample::Line(ink, width) => self.line(&[(x, y), (x + 21.0, y)], ink, width),
                Sample::Upright(ink, width) => {
                    self.line(&[(x + 12.0, y - 5.0), (x + 12.0, y + 5.0)], ink, width);
                }
                Sample::Dot(dot) => self.dot((x + 12.0, y), 3.0, dot),
                Sample::Block(tint) => {
                    self.rectangle((x + 5.0, y - 5.0), (x + 21.0, y + 5.0), tint);
                }
            }
            let font = Font(LABEL_PX, TEXT, Anchor::Start, Height::Middle);
            self.text((x + 26.0, y), text, font);
            x += 42.0 + text_width_px(text, LABEL_PX);
        }
    }

    /// The finished plot; `label` describes it for screen readers, and `data` is for the page's script.
    pub(crate) fn finish(self, height_px: f64, label: &str, data: &[(&str, f64)]) -> String {
        let mut attributes = String::new();
        for (name, value) in data {
            let _ = write!(attributes, " data-{name}=\"{value}\"");
        }
        let (width, height) = (px(WIDTH_PX), px(height_px));
        let label = label.replace('&', "&amp;").replace('"', "&quot;");
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" aria-label=\"{label}\" font-family=\"Helvetica Neue, Helvetica, Arial, \
             Liberation Sans, sans-serif\" stroke-linejoin=\"round\"{attributes}>\n{}</svg>\n",
            self.svg
        )
    }
}
