//! A flight plan as a page: its table, its map and its height profile.

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table};
use maud::{DOCTYPE, PreEscaped, html};

use crate::page::STYLE;
use crate::plot::Figure;
use crate::plot::axis::Axis;
use crate::plot::panel::{Frame, Panel};
use crate::plot::sheet::{
    ACTUAL, Anchor, Dot, FAINT, Font, GRID, Height, MARK, OTHER, SMALL_PX, Sheet, WIDTH_PX,
};
use crate::table::{markup, table};

const LEFT_PX: f64 = 60.0;
const TOP_PX: f64 = 12.0;
const X_LABELS_PX: f64 = 36.0;
const MAP_HEIGHT_PX: f64 = 460.0;
const PROFILE_HEIGHT_PX: f64 = 160.0;
/// What is shown around the places, as a share of their extent, and at least, m.
const MARGIN: f64 = 0.1;
const LEAST_MARGIN_M: f64 = 100.0;
/// What is outside of the fence is found in squares of so many px.
const SQUARE_PX: f64 = 4.0;
/// Corners of a drawn circle.
const CORNERS: u32 = 90;

/// A place of a plan, for its picture.
#[derive(Clone, PartialEq, Debug)]
pub struct PlanPlace {
    /// The number of its item; none for home.
    pub item: Option<usize>,
    /// North of the first place, m.
    pub north_m: f64,
    /// East of it, m.
    pub east_m: f64,
    /// Above mean sea level, m.
    pub altitude_m: f64,
    /// The length of the legs to here, m.
    pub along_m: f64,
    /// Of the circle around it, if there is one, m.
    pub circle_m: Option<f64>,
}

/// A row of a plan's table: item, what it is, place, altitude, length and course of the
/// leg to it.
pub type PlanRow = [String; 6];

fn table_of(rows: &[PlanRow]) -> Table {
    let mut table = table(&["Item", "", "Place", "Altitude above", "Leg", "Course"]);
    table.add_rows(rows);
    table
}

/// A plan's table as text.
pub fn plan_table(rows: &[PlanRow]) -> String {
    /// Of a terminal.
    const COLUMNS: u16 = 80;
    let mut table = table_of(rows);
    table.set_content_arrangement(ContentArrangement::Dynamic);
    for (n, column) in table.column_iter_mut().enumerate() {
        if n == 1 {
            column.set_cell_alignment(CellAlignment::Left);
        } else {
            column.set_constraint(ColumnConstraint::ContentWidth);
        }
    }
    table.set_width(COLUMNS).to_string()
}

/// A line on the ground, (east, north) of the first place, m.
pub type PlanLine = Vec<(f64, f64)>;

/// A fence on a map.
pub struct PlanFence {
    /// The sides of its zones.
    pub sides: Vec<PlanLine>,
    /// Whether it permits a place, (east, north) of the first place, m.
    pub permits: Box<dyn Fn((f64, f64)) -> bool>,
}

/// A point of the ground below a plan: the length of the legs to there, and its elevation
/// above mean sea level, if that is known, m.
pub type GroundPoint = (f64, Option<f64>);

/// A page with a plan's table, map with its fence, and height profile over the ground.
pub fn plan_page(
    title: &str,
    rows: &[PlanRow],
    places: &[PlanPlace],
    fence: &PlanFence,
    ground: &[GroundPoint],
) -> String {
    let table = table_of(rows);
    let figures = figures(places, fence, ground);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                @for figure in &figures {
                    figure {
                        figcaption { b { (figure.title) } " " (figure.caption) }
                        (PreEscaped(&figure.svg))
                    }
                }
                (markup(&table, &[1, 2]))
            }
        }
    };
    page.into_string()
}

fn figures(places: &[PlanPlace], fence: &PlanFence, ground: &[GroundPoint]) -> Vec<Figure> {
    if places.is_empty() && fence.sides.is_empty() {
        return Vec::new();
    }
    let map = Figure {
        title: "Map".to_owned(),
        caption: "North up, from the first place; numbers are those of the items, light lines the \
                  fence. Where it does not permit to fly is grey."
            .to_owned(),
        svg: map(places, fence),
    };
    // A fence alone has no heights.
    if places.is_empty() {
        return vec![map];
    }
    let profile = Figure {
        title: "Height profile".to_owned(),
        caption: if ground.is_empty() {
            "Above mean sea level, along the legs without turns and loiters.".to_owned()
        } else {
            "Above mean sea level, along the legs without turns and loiters. The light line is \
             the ground; where it is missing, its elevation is not known."
                .to_owned()
        },
        svg: profile(places, ground),
    };
    vec![map, profile]
}

/// The lowest and the highest of values, with a margin.
fn around(values: impl Iterator<Item = f64> + Clone, least_m: f64) -> (f64, f64) {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(f64::NEG_INFINITY, f64::max);
    let margin = (MARGIN * (high - low)).max(least_m);
    (low - margin, high + margin)
}

fn map(places: &[PlanPlace], fence: &PlanFence) -> String {
    let reach = |place: &PlanPlace| place.circle_m.unwrap_or(0.0);
    let ends = |of: fn(&PlanPlace) -> f64| {
        let each = places.iter();
        each.flat_map(move |place| [of(place) - reach(place), of(place) + reach(place)])
    };
    let corners = || fence.sides.iter().flatten();
    let (east_m, north_m) = (
        around(
            ends(|place| place.east_m).chain(corners().map(|at| at.0)),
            LEAST_MARGIN_M,
        ),
        around(
            ends(|place| place.north_m).chain(corners().map(|at| at.1)),
            LEAST_MARGIN_M,
        ),
    );
    let span = |(low, high): (f64, f64)| high - low;
    let width_px = WIDTH_PX - LEFT_PX - 12.0;
    // The same scale in both directions.
    let m_per_px = (span(east_m) / width_px).max(span(north_m) / MAP_HEIGHT_PX);
    let widened = |(low, high): (f64, f64), to_px: f64| {
        let (middle, half) = (f64::midpoint(low, high), 0.5 * to_px * m_per_px);
        ((middle - half) / 1e3, (middle + half) / 1e3)
    };
    let panel = Panel {
        frame: frame(width_px, MAP_HEIGHT_PX),
        x: Axis::exactly(widened(east_m, width_px), 6, "east, km"),
        y: Axis::exactly(widened(north_m, MAP_HEIGHT_PX), 5, "north, km"),
    };
    let mut sheet = Sheet::default();
    if !fence.sides.is_empty() {
        outside(&panel, &mut sheet, fence);
    }
    panel.axes(&mut sheet, true, "");
    let at = |place: &PlanPlace| (place.east_m / 1e3, place.north_m / 1e3);
    for line in &fence.sides {
        let line: Vec<_> = line.iter().map(|at| (at.0 / 1e3, at.1 / 1e3)).collect();
        panel.line(&mut sheet, &line, MARK, 1.4);
    }
    for place in places {
        if let Some(radius_m) = place.circle_m {
            let (east, north) = at(place);
            let circle: Vec<_> = (0..=CORNERS)
                .map(|corner| {
                    let angle = std::f64::consts::TAU * f64::from(corner) / f64::from(CORNERS);
                    let radius = radius_m / 1e3;
                    (east + radius * angle.sin(), north + radius * angle.cos())
                })
                .collect();
            panel.line(&mut sheet, &circle, OTHER, 1.0);
        }
    }
    places_and_lines(&panel, &mut sheet, places, at);
    sheet.finish(TOP_PX + MAP_HEIGHT_PX + X_LABELS_PX, "Map", &[])
}

/// Fills what the fence does not permit, row by row.
fn outside(panel: &Panel, sheet: &mut Sheet, fence: &PlanFence) {
    let Panel { frame, x, y } = panel;
    let columns = ((frame.right - frame.left) / SQUARE_PX) as u32;
    let rows = ((frame.bottom - frame.top) / SQUARE_PX) as u32;
    let at = |axis: &Axis, share: f64| axis.from + (axis.to - axis.from) * share;
    let east = |column: f64| at(x, column / f64::from(columns));
    let north = |row: f64| at(y, row / f64::from(rows));
    for row in 0..rows {
        let north_m = 1e3 * north(f64::from(row) + 0.5);
        let is_outside = |column: &u32| {
            let east_m = 1e3 * east(f64::from(*column) + 0.5);
            !(fence.permits)((east_m, north_m))
        };
        let mut columns = (0..columns).peekable();
        while let Some(first) = columns.find(is_outside) {
            let mut end = first + 1;
            while columns.next_if(is_outside).is_some() {
                end += 1;
            }
            let [south_west, north_east] = [(first, row), (end, row + 1)]
                .map(|(column, row)| (east(f64::from(column)), north(f64::from(row))));
            panel.fill(sheet, south_west, north_east, GRID);
        }
    }
}

fn profile(places: &[PlanPlace], ground: &[GroundPoint]) -> String {
    let elevations = ground.iter().filter_map(|(_, elevation_m)| *elevation_m);
    let width_px = WIDTH_PX - LEFT_PX - 12.0;
    let along_km = (
        0.0,
        places
            .last()
            .map_or(0.0, |place| place.along_m / 1e3)
            .max(0.1),
    );
    let panel = Panel {
        frame: frame(width_px, PROFILE_HEIGHT_PX),
        x: Axis::exactly(along_km, 6, "along the plan, km"),
        y: Axis::exactly(
            around(
                places
                    .iter()
                    .map(|place| place.altitude_m)
                    .chain(elevations),
                20.0,
            ),
            3,
            "altitude, m",
        ),
    };
    let mut sheet = Sheet::default();
    panel.axes(&mut sheet, true, "");
    for known in ground.split(|(_, elevation_m)| elevation_m.is_none()) {
        let line: Vec<_> = known
            .iter()
            .filter_map(|(along_m, elevation_m)| Some((along_m / 1e3, (*elevation_m)?)))
            .collect();
        if !line.is_empty() {
            panel.line(&mut sheet, &line, OTHER, 1.4);
        }
    }
    places_and_lines(&panel, &mut sheet, places, |place| {
        (place.along_m / 1e3, place.altitude_m)
    });
    sheet.finish(
        TOP_PX + PROFILE_HEIGHT_PX + X_LABELS_PX,
        "Height profile",
        &[],
    )
}

fn frame(width_px: f64, height_px: f64) -> Frame {
    Frame {
        left: LEFT_PX,
        top: TOP_PX,
        right: LEFT_PX + width_px,
        bottom: TOP_PX + height_px,
    }
}

fn places_and_lines(
    panel: &Panel,
    sheet: &mut Sheet,
    places: &[PlanPlace],
    at: impl Fn(&PlanPlace) -> (f64, f64),
) {
    let line: Vec<_> = places.iter().map(&at).collect();
    panel.line(sheet, &line, ACTUAL, 1.4);
    let font = Font(SMALL_PX, FAINT, Anchor::Start, Height::Bottom);
    for place in places {
        let (dot, name) = match place.item {
            Some(item) => (Dot::Filled(ACTUAL), item.to_string()),
            None => (Dot::Open(ACTUAL, 1.2), "home".to_owned()),
        };
        panel.dot(sheet, at(place), 3.0, dot);
        let (x, y) = panel.place(at(place));
        sheet.text((x + 5.0, y - 4.0), &name, font);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_both_pictures_and_every_item() {
        let place = |item, north_m| PlanPlace {
            item,
            north_m,
            east_m: 0.5 * north_m,
            altitude_m: 900.0,
            along_m: north_m,
            circle_m: item.map(|_| 500.0),
        };
        let places = [
            place(None, 0.0),
            place(Some(1), 4_000.0),
            place(Some(2), 9_000.0),
        ];
        let mut fence = PlanFence {
            sides: Vec::new(),
            permits: Box::new(|(east_m, _)| east_m <= 0.0),
        };
        let page = plan_page("A <plan>", &[], &places, &fence, &[]);
        assert_eq!(page.matches("<svg").count(), 2);
        let ground = [(0.0, Some(500.0)), (500.0, None), (900.0, Some(700.0))];
        let over_ground = plan_page("A plan", &[], &places, &fence, &ground);
        assert!(over_ground.contains("The light line is the ground"));
        assert!(page.contains("A &lt;plan&gt;") && page.contains("home"));
        // East of home a rectangle in each of the 115 rows.
        fence.sides.push(vec![(0.0, -1_000.0), (0.0, 9_000.0)]);
        let fenced = plan_page("A plan", &[], &places, &fence, &[]);
        let grey = |page: &str| page.matches("<rect").count();
        assert_eq!(grey(&fenced) - grey(&page), 115);
        let alone = plan_page("A fence", &[], &[], &fence, &[]);
        assert_eq!(alone.matches("<svg").count(), 1);
    }
}
