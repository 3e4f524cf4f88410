//! The artificial horizon.

use fcc_fixed_wing::Autopilot;
use ratatui::Frame;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Style};
use ratatui::widgets::{Paragraph, Widget};

use crate::picture::Picture;

/// A character is about twice as high as it is wide.
const ASPECT: f64 = 2.0;
/// Pitch range from the middle to the upper edge, degrees.
const REACH_DEG: f64 = 20.0;
/// Interval of the pitch ladder, degrees.
const RUNG_DEG: f64 = 10.0;
/// Half the width of a rung, columns.
const RUNG_COLUMNS: f64 = 3.5;

const SKY: Color = Color::Blue;
const GROUND: Color = Color::Yellow;

/// Draws the horizon when the attitude is known.
pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, picture: &Picture<Autopilot>) {
    match &picture.record {
        Some(record) if !record.measurements.attitude.is_never() => {
            let attitude = record.measurements.attitude.value;
            frame.render_widget(
                Horizon {
                    pitch_rad: attitude.pitch_rad,
                    roll_rad: attitude.roll_rad,
                },
                area,
            );
        }
        _ => frame.render_widget(Paragraph::new("no attitude yet"), area),
    }
}

/// The view of a pilot: sky above ground, the ground higher on the side of the
/// lower wing.
struct Horizon {
    pitch_rad: f64,
    roll_rad: f64,
}

impl Horizon {
    /// The direction of a point of the picture, `x` columns right and `y`
    /// columns up from its middle: degrees above the horizon, and columns along
    /// it.
    fn look(&self, x: f64, y: f64, deg_per_column: f64) -> (f64, f64) {
        let (sin, cos) = self.roll_rad.sin_cos();
        let above_deg = self.pitch_rad.to_degrees() + (y * cos - x * sin) * deg_per_column;
        (above_deg, x * cos + y * sin)
    }
}

impl Widget for Horizon {
    fn render(self, area: Rect, buffer: &mut Buffer) {
        let half_height = f64::from(area.height) * ASPECT / 2.0;
        let half_width = f64::from(area.width) / 2.0;
        let deg_per_column = REACH_DEG / half_height.max(1.0);
        // Each character is two squares, the lower and the upper.
        let is_ground = |x, y| self.look(x, y, deg_per_column).0 < 0.0;
        for row in 0..area.height {
            let y = half_height - (f64::from(row) + 0.5) * ASPECT;
            for column in 0..area.width {
                let x = f64::from(column) + 0.5 - half_width;
                let square = match (is_ground(x, y + 0.5), is_ground(x, y - 0.5)) {
                    (false, false) => ' ',
                    (false, true) => '▄',
                    (true, false) => '▀',
                    (true, true) => '█',
                };
                let (above_deg, along) = self.look(x, y, deg_per_column);
                let rung = (above_deg / RUNG_DEG).round();
                let on_rung = rung != 0.0
                    && along.abs() <= RUNG_COLUMNS
                    && (above_deg - rung * RUNG_DEG).abs() <= deg_per_column * ASPECT / 2.0;
                let (letter, style) = if on_rung {
                    let back = if above_deg < 0.0 { GROUND } else { SKY };
                    ('─', Style::new().fg(Color::White).bg(back))
                } else {
                    (square, Style::new().fg(GROUND).bg(SKY))
                };
                let at = Position::new(area.x + column, area.y + row);
                if let Some(cell) = buffer.cell_mut(at) {
                    cell.set_char(letter).set_style(style);
                }
            }
        }
        aircraft(area, buffer);
    }
}

/// The symbol of the aircraft, which does not move.
fn aircraft(area: Rect, buffer: &mut Buffer) {
    const WINGS: &str = "──── ● ────";
    let width = WINGS.chars().count() as u16;
    if area.width < width {
        return;
    }
    let at = (
        area.x + (area.width - width) / 2,
        area.y + area.height.saturating_sub(1) / 2,
    );
    for (n, letter) in WINGS.chars().enumerate() {
        if letter == ' ' {
            continue;
        }
        if let Some(cell) = buffer.cell_mut(Position::new(at.0 + n as u16, at.1)) {
            cell.set_char(letter)
                .set_style(Style::new().fg(Color::White).bg(Color::Black));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(pitch_deg: f64, roll_deg: f64) -> Vec<String> {
        let area = Rect::new(0, 0, 21, 11);
        let mut buffer = Buffer::empty(area);
        Horizon {
            pitch_rad: f64::to_radians(pitch_deg),
            roll_rad: f64::to_radians(roll_deg),
        }
        .render(area, &mut buffer);
        (0..11)
            .map(|y| (0..21).map(|x| buffer[(x, y)].symbol()).collect())
            .collect()
    }

    #[test]
    fn in_level_flight_the_lower_half_is_ground() {
        let rows = drawn(0.0, 0.0);
        assert_eq!((&rows[0][..1], rows[10].contains('█')), (" ", true));
    }

    #[test]
    fn at_a_high_pitch_only_sky_is_visible() {
        assert!(drawn(25.0, 0.0).iter().all(|row| !row.contains('█')));
    }

    /// Right wing down: the ground rises on the right.
    #[test]
    fn banked_right_the_ground_is_on_the_right() {
        let rows = drawn(0.0, 45.0);
        let middle: Vec<char> = rows[4].chars().collect();
        assert_eq!((middle[0], middle[20]), (' ', '█'));
    }
}
