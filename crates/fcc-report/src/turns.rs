//! Headings as lines: counted on through north, and folded back for a plot.

use super::trace::Point;

const FULL_TURN_DEG: f64 = 360.0;

/// Counts a heading on through full turns, so that a line through it does not
/// jump at north.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turns {
    last_deg: Option<f64>,
}

impl Turns {
    /// The heading next to the one before, whichever way is shorter; next to
    /// `from_deg` if there is none before.
    pub(super) fn count(&mut self, heading_deg: f64, from_deg: f64) -> f64 {
        let from_deg = self.last_deg.unwrap_or(from_deg);
        let counted = from_deg + shorter_way(heading_deg - from_deg);
        self.last_deg = Some(counted);
        counted
    }

    /// Forgets the heading before.
    pub(super) fn forget(&mut self) {
        self.last_deg = None;
    }
}

/// The same angle in -180..180.
fn shorter_way(angle_deg: f64) -> f64 {
    (angle_deg + 180.0).rem_euclid(FULL_TURN_DEG) - 180.0
}

/// Where to cut the circle so that the lines cross the cut as little as can
/// be, in 0..360: the middle of the widest sector in which they spend the
/// least time, by sectors of 15°.
pub(super) fn seam_deg<'a>(lines: impl IntoIterator<Item = &'a Vec<Point>>) -> f64 {
    const SECTORS: usize = 24;
    const SECTOR_DEG: f64 = FULL_TURN_DEG / SECTORS as f64;
    let mut spent_s = [0.0; SECTORS];
    for pair in lines.into_iter().flat_map(|line| line.windows(2)) {
        if let [from, to] = pair {
            let sector = (from.value.rem_euclid(FULL_TURN_DEG) / SECTOR_DEG) as usize;
            if let Some(spent) = spent_s.get_mut(sector % SECTORS) {
                *spent += to.time_s - from.time_s;
            }
        }
    }
    // Sectors next to it count too: what is seldom there may come near.
    let around = |sector: usize| -> f64 {
        (SECTORS - 2..=SECTORS + 2)
            .filter_map(|near| spent_s.get((sector + near) % SECTORS))
            .sum()
    };
    let quietest = (0..SECTORS).min_by(|a, b| around(*a).total_cmp(&around(*b)));
    (quietest.unwrap_or(0) as f64 + 0.5) * SECTOR_DEG
}

/// Folds a line into the turn that begins at `seam_deg`: it leaves at one edge
/// and comes back at the other.
pub(super) fn fold(line: &[Point], seam_deg: f64) -> Vec<Vec<Point>> {
    let turn = |value: f64| ((value - seam_deg) / FULL_TURN_DEG).floor();
    let mut lines = Vec::new();
    let mut folded: Vec<Point> = Vec::new();
    let mut before: Option<Point> = None;
    for point in line {
        if let Some(before) = before {
            let (from, to) = (turn(before.value), turn(point.value));
            if from != to {
                // The edge that is crossed belongs to the upper turn.
                let edge = seam_deg + FULL_TURN_DEG * from.max(to);
                let share = (edge - before.value) / (point.value - before.value);
                let time_s = before.time_s + share * (point.time_s - before.time_s);
                let (out, back) = if to > from {
                    (seam_deg + FULL_TURN_DEG, seam_deg)
                } else {
                    (seam_deg, seam_deg + FULL_TURN_DEG)
                };
                folded.push(Point { time_s, value: out });
                lines.push(std::mem::take(&mut folded));
                folded.push(Point {
                    time_s,
                    value: back,
                });
            }
        }
        folded.push(Point {
            value: point.value - FULL_TURN_DEG * turn(point.value),
            ..*point
        });
        before = Some(*point);
    }
    lines.push(folded);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(values: &[f64]) -> Vec<Point> {
        (0..)
            .zip(values)
            .map(|(n, value)| Point {
                time_s: f64::from(n),
                value: *value,
            })
            .collect()
    }

    #[test]
    fn a_heading_is_counted_on_through_north() {
        let mut turns = Turns::default();
        let counted: Vec<_> = [350.0, 355.0, 2.0, 90.0, 180.0, 270.0, 10.0, 350.0]
            .map(|heading| turns.count(heading, 0.0))
            .into();
        assert_eq!(
            counted,
            [-10.0, -5.0, 2.0, 90.0, 180.0, 270.0, 370.0, 350.0]
        );
    }

    /// Four headings held, turned between: cut between two of them.
    #[test]
    fn the_circle_is_cut_where_nobody_flies() {
        let held: Vec<_> = [80.0, 170.0, 260.0, 350.0]
            .into_iter()
            .flat_map(|heading| [heading; 20])
            .collect();
        let seam = seam_deg([&line(&held)]);
        let nearest = [80.0, 170.0, 260.0, 350.0]
            .into_iter()
            .map(|heading| shorter_way(heading - seam).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(nearest >= 30.0, "{seam}");
    }

    #[test]
    fn a_folded_line_leaves_at_one_edge_and_comes_back_at_the_other() {
        let folded = fold(&line(&[350.0, 370.0, 350.0]), 0.0);
        let values: Vec<Vec<f64>> = folded
            .iter()
            .map(|line| line.iter().map(|point| point.value).collect())
            .collect();
        assert_eq!(
            values,
            [vec![350.0, 360.0], vec![0.0, 10.0, 0.0], vec![360.0, 350.0]]
        );
        assert_eq!(folded[0][1].time_s, 0.5);
    }
}
