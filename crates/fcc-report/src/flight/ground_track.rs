//! The ground track, from measured positions.

use super::track::{PlanLines, Track, TrackPoint};
use crate::events::Weight;
use crate::plot::Figure;
use crate::plot::axis::Axis;
use crate::plot::panel::{Frame, Panel};
use crate::plot::sheet::{
    ACTUAL, Anchor, DESIRED, Dot, FAINT, Font, Height, MARK, OTHER, SMALL_PX, Sample, Sheet,
    WIDTH_PX,
};
use crate::report::RunReport;
use crate::states::Phase;

const LEFT_PX: f64 = 60.0;
const TOP_PX: f64 = 24.0;
const X_LABELS_PX: f64 = 36.0;
/// Largest height, px.
const MOST_HEIGHT_PX: f64 = 460.0;
const LEAST_HEIGHT_PX: f64 = 160.0;
/// A shorter track is drawn on a map of this size, m.
const LEAST_SPAN_M: f64 = 100.0;

/// The ground track; `None` without positions.
pub(super) fn figure(report: &RunReport, track: &Track, planned: &PlanLines) -> Option<Figure> {
    let planned = [&planned.path, &planned.fence].map(|lines| track.drawn(lines));
    let track = track.places();
    if track.is_empty() {
        return None;
    }
    let map = Map::of(track, &planned);
    let mut sheet = Sheet::default();
    map.paint(&mut sheet, report, track, &planned);
    Some(Figure {
        title: "Ground track".to_owned(),
        caption: "Over the ground, north up, from the first measured position; numbers are \
                  the changes of state in the table of events."
            .to_owned(),
        svg: sheet.finish(TOP_PX + map.height_px + X_LABELS_PX, "Ground track", &[]),
    })
}

/// Lines of a plan and of its fence, (east, north), m.
type Planned = [Vec<Vec<(f64, f64)>>; 2];

/// The same scale in both directions.
struct Map {
    east_m: (f64, f64),
    north_m: (f64, f64),
    width_px: f64,
    height_px: f64,
}

impl Map {
    fn of(track: &[TrackPoint], planned: &Planned) -> Self {
        let flown = track.iter().map(|point| (point.east_m, point.north_m));
        let drawn = planned.iter().flatten().flatten().copied();
        let all: Vec<_> = flown.chain(drawn).collect();
        let around = |of: fn(&(f64, f64)) -> f64| {
            let low = all.iter().map(of).fold(f64::INFINITY, f64::min);
            let high = all.iter().map(of).fold(f64::NEG_INFINITY, f64::max);
            let reach = (high - low).max(LEAST_SPAN_M) * 0.56;
            let middle = f64::midpoint(low, high);
            (middle - reach, middle + reach)
        };
        let (east_m, north_m) = (around(|at| at.0), around(|at| at.1));
        let span = |(low, high): (f64, f64)| high - low;
        let most_width_px = WIDTH_PX - LEFT_PX - 12.0;
        let m_per_px = (span(east_m) / most_width_px).max(span(north_m) / MOST_HEIGHT_PX);
        let height_px = (span(north_m) / m_per_px).max(LEAST_HEIGHT_PX);
        let widen = |(low, high): (f64, f64), to_px: f64| {
            let reach = to_px * m_per_px / 2.0;
            let middle = f64::midpoint(low, high);
            (middle - reach, middle + reach)
        };
        // A narrow track gets margins, not a narrow map.
        let width_px = most_width_px;
        Self {
            east_m: widen(east_m, width_px),
            north_m: widen(north_m, height_px),
            width_px,
            height_px,
        }
    }

    fn paint(
        &self,
        sheet: &mut Sheet,
        report: &RunReport,
        track: &[TrackPoint],
        planned: &Planned,
    ) {
        let span_m = self.east_m.1 - self.east_m.0;
        let (unit_m, unit) = if span_m > 3_000.0 {
            (1_000.0, "km")
        } else {
            (1.0, "m")
        };
        let axis = |range: (f64, f64), count_px: f64, name: &str| {
            let count = (count_px / 90.0).max(2.0) as usize;
            let title = format!("{name}, {unit}");
            Axis::exactly((range.0 / unit_m, range.1 / unit_m), count, &title)
        };
        let frame = Frame {
            left: LEFT_PX,
            top: TOP_PX,
            right: LEFT_PX + self.width_px,
            bottom: TOP_PX + self.height_px,
        };
        let x = axis(self.east_m, self.width_px, "east");
        let y = axis(self.north_m, self.height_px, "north");
        let panel = Panel { frame, x, y };
        panel.axes(sheet, true, "");
        let at = |place: &TrackPoint| (place.east_m / unit_m, place.north_m / unit_m);
        let mut entries = Vec::new();
        let kinds = [(DESIRED, "plan"), (MARK, "fence")];
        for (lines, (ink, name)) in planned.iter().zip(kinds) {
            for line in lines {
                let line: Vec<_> = line
                    .iter()
                    .map(|at| (at.0 / unit_m, at.1 / unit_m))
                    .collect();
                panel.line(sheet, &line, ink, 1.2);
            }
            if !lines.is_empty() {
                entries.push((Sample::Line(ink, 1.2), name));
            }
        }
        for (phase, places) in stretches(report, track) {
            let (ink, width_px) = match phase {
                Phase::Engaged => (ACTUAL, 1.4),
                _ => (OTHER, 1.0),
            };
            let points = smooth(&panel, places.iter().map(at));
            panel.line(sheet, &points, ink, width_px);
        }
        let dots = [Dot::Open(ACTUAL, 1.2), Dot::Filled(ACTUAL)];
        for (place, dot) in [track.first(), track.last()]
            .into_iter()
            .flatten()
            .zip(dots)
        {
            panel.dot(sheet, at(place), 3.5, dot);
        }
        let flown = [
            (Sample::Line(ACTUAL, 1.4), "engaged"),
            (Sample::Line(OTHER, 1.0), "not engaged"),
            (Sample::Dot(Dot::Open(ACTUAL, 1.2)), "begin"),
            (Sample::Dot(Dot::Filled(ACTUAL)), "end"),
        ];
        sheet.legend((LEFT_PX, 10.0), flown.into_iter().chain(entries));
        number_states(sheet, report, track, &panel, at);
    }
}

/// Keeps the points that can be distinguished in the plot, and the last: closer
/// points show only the receiver's noise.
fn smooth(panel: &Panel, points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    const APART_PX: f64 = 3.0;
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    for point in points {
        let (x, y) = panel.place(point);
        let is_far = kept.last().is_none_or(|kept| {
            let (u, v) = panel.place(*kept);
            (u - x).hypot(v - y) >= APART_PX
        });
        last = (!is_far).then_some(point);
        if is_far {
            kept.push(point);
        }
    }
    kept.extend(last);
    kept
}

/// The track in pieces of one state each, which touch.
fn stretches(report: &RunReport, track: &[TrackPoint]) -> Vec<(Phase, Vec<TrackPoint>)> {
    let mut spans = report.states.iter().peekable();
    let mut pieces: Vec<(Phase, Vec<TrackPoint>)> = Vec::new();
    let mut phase = Phase::Standby;
    for place in track {
        while let Some(span) = spans.next_if(|span| span.from_s <= place.time_s) {
            phase = span.phase;
        }
        match pieces.last_mut() {
            Some((last, places)) if *last == phase => places.push(*place),
            Some((_, places)) => {
                // The previous piece ends where this one begins.
                places.push(*place);
                pieces.push((phase, vec![*place]));
            }
            None => pieces.push((phase, vec![*place])),
        }
    }
    pieces
}

/// Numbers the events that changed the state, at their positions.
fn number_states(
    sheet: &mut Sheet,
    report: &RunReport,
    track: &[TrackPoint],
    panel: &Panel,
    at: impl Fn(&TrackPoint) -> (f64, f64),
) {
    let font = Font(SMALL_PX, FAINT, Anchor::Start, Height::Bottom);
    let mut taken: Vec<(f64, f64)> = Vec::new();
    for event in report.events.iter().filter(|e| e.weight == Weight::State) {
        let after = track.partition_point(|p| p.time_s < event.time_s);
        let Some(place) = track.get(after).or(track.last()) else {
            continue;
        };
        let (x, y) = panel.place(at(place));
        // One number where several would overlap.
        if taken.iter().all(|(u, v)| (u - x).hypot(v - y) > 14.0) {
            taken.push((x, y));
            let number = event.number.to_string();
            sheet.text((x + 5.0, y - 4.0), &number, font);
        }
    }
}
