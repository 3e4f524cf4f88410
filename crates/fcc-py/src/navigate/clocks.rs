//! Whether a receiver sees turns when the gyroscope does.

use fcc_core::blocks::wrap_pi;
use fcc_core::flight::inertial::metres_per_radian;
use nalgebra::Vector3;

use super::kind::{Kind, Series};
use super::mounting::Mounting;
use super::plausible::{CLEARLY, WINDOW_S};

/// Turns are compared with those before and after, up to this and in such steps, s: the
/// clocks of GPS and UTC differ by 18 s.
const LARGEST_S: f64 = 30.0;
const STEP_S: f64 = 0.1;
/// What is later than this, s, is worth a word: the filter finds less by itself.
const LATE_S: f64 = 0.5;
/// What moves slower, m/s, has no course.
const MOVING_MPS: f64 = 3.0;
/// Positions show a course if they are so far apart, m.
const APART_M: f64 = 10.0;
/// Gravity is smoothed by this, s.
const SMOOTHED_S: f64 = 1.0;
/// A gyroscope says nothing of a longer gap, s, and is compared over so many steps at most.
const CONNECTED_S: f64 = 0.2;
const MOST_STEPS: usize = 10_000_000;
/// Turns are compared in at least so many windows, of this root mean square at least, rad,
/// and the gyroscope explains so much of them at best.
const LEAST_WINDOWS: usize = 10;
const LEAST_TURN: f64 = 0.17;
const EXPLAINED: f64 = 0.8;

/// How late the turns of a receiver come after those of the gyroscope, if that is another
/// time than was given.
pub(super) fn late(
    (kind, receiver): (&Kind, &Series),
    delay_s: f64,
    heading: &Heading,
) -> Option<String> {
    let courses = if kind.name == "gnss_position" {
        of_positions(kind, receiver)
    } else {
        of_velocities(kind, receiver)
    };
    let turns = turns(&courses, delay_s);
    let square: f64 = turns.iter().map(|turn| turn.by_rad * turn.by_rad).sum();
    if turns.len() < LEAST_WINDOWS || square < turns.len() as f64 * LEAST_TURN * LEAST_TURN {
        return None;
    }
    let given = heading.left(&turns, 0.0)?;
    let steps = (LARGEST_S / STEP_S) as i32;
    let (best, late_s) = (-steps..=steps)
        .filter_map(|step| {
            let late_s = f64::from(step) * STEP_S;
            Some((heading.left(&turns, late_s)?, late_s))
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    let is_other = late_s.abs() > LATE_S && best < 1.0 - EXPLAINED && given > CLEARLY * best;
    is_other.then(|| {
        let than = if late_s > 0.0 { "later" } else { "earlier" };
        format!(
            "{}: it turns {:.1} s {than} than the gyroscope: give times of one clock, those at \
             which samples were taken",
            kind.name,
            late_s.abs()
        )
    })
}

/// By how much the course changes from one time to another.
struct Turn {
    from_s: f64,
    to_s: f64,
    by_rad: f64,
}

/// The change of courses in windows without a gap.
fn turns(courses: &[(f64, Option<f64>)], delay_s: f64) -> Vec<Turn> {
    let mut turns = Vec::new();
    let mut open: Option<(f64, f64, f64)> = None;
    for (time_s, course) in courses {
        let (Some(course), time_s) = (course, time_s - delay_s) else {
            open = None;
            continue;
        };
        let Some((from_s, last, turned)) = open else {
            open = Some((time_s, *course, 0.0));
            continue;
        };
        let turned = turned + wrap_pi(course - last);
        if time_s - from_s < WINDOW_S {
            open = Some((from_s, *course, turned));
            continue;
        }
        open = Some((time_s, *course, 0.0));
        if time_s - from_s < 2.0 * WINDOW_S {
            turns.push(Turn {
                from_s,
                to_s: time_s,
                by_rad: turned,
            });
        }
    }
    turns
}

fn of_velocities(kind: &Kind, velocity: &Series) -> Vec<(f64, Option<f64>)> {
    let samples = velocity.times_s.iter().zip(&velocity.rows);
    samples
        .filter(|(_, row)| kind.is_possible(row))
        .map(|(time_s, [north, east, _])| {
            let moves = north.hypot(*east) > MOVING_MPS;
            (*time_s, moves.then(|| east.atan2(*north)))
        })
        .collect()
}

fn of_positions(kind: &Kind, position: &Series) -> Vec<(f64, Option<f64>)> {
    let mut courses = Vec::new();
    let mut from: Option<(f64, [f64; 3])> = None;
    let samples = position.times_s.iter().zip(&position.rows);
    for (time_s, place) in samples.filter(|(_, row)| kind.is_possible(row)) {
        let Some((since_s, before)) = from else {
            from = Some((*time_s, *place));
            continue;
        };
        let (per_latitude, per_longitude) = metres_per_radian(before[0], before[2]);
        let north = (place[0] - before[0]) * per_latitude;
        let east = wrap_pi(place[1] - before[1]) * per_longitude;
        let (far, passed_s) = (north.hypot(east), time_s - since_s);
        if far < APART_M && passed_s < APART_M / MOVING_MPS {
            continue;
        }
        from = Some((*time_s, *place));
        let moves = far > MOVING_MPS * passed_s;
        courses.push((0.5 * (since_s + time_s), moves.then(|| east.atan2(north))));
    }
    courses
}

/// The heading by the gyroscope alone, around what the accelerometer holds for down: from
/// its first sample on, in equal steps.
pub(super) struct Heading {
    begin_s: f64,
    steps_rad: Vec<f64>,
}

impl Heading {
    pub(super) fn of(
        gyroscope: (&Kind, &Series),
        accelerometer: (&Kind, &Series),
        mounting: &Mounting,
    ) -> Option<Self> {
        let mut forces = mounting.possible(accelerometer).peekable();
        let mut down: Option<Vector3<f64>> = None;
        let mut forces_s = 0.0;
        let (mut last_s, mut heading_rad) = (None, 0.0);
        let mut heading: Option<Self> = None;
        for (time_s, rate) in mounting.possible(gyroscope) {
            while let Some((at_s, force)) = forces.next_if(|(at_s, _)| *at_s <= time_s) {
                let Some(now) = (-force).try_normalize(1.0) else {
                    continue;
                };
                let share = 1.0 - (-(at_s - forces_s) / SMOOTHED_S).exp();
                forces_s = at_s;
                down = Some(down.map_or(now, |down| down + (now - down) * share.max(0.0)));
            }
            let Some(down) = down.and_then(|down| down.try_normalize(0.1)) else {
                continue;
            };
            let heading = heading.get_or_insert_with(|| Self {
                begin_s: time_s,
                steps_rad: Vec::new(),
            });
            let passed_s = time_s - last_s.unwrap_or(time_s);
            heading_rad += rate.dot(&down) * passed_s.clamp(0.0, CONNECTED_S);
            last_s = Some(time_s);
            let steps = ((time_s - heading.begin_s) / STEP_S) as usize;
            if steps > MOST_STEPS {
                break;
            }
            if heading.steps_rad.len() <= steps {
                heading.steps_rad.resize(steps + 1, heading_rad);
            }
        }
        heading
    }

    fn at(&self, time_s: f64) -> Option<f64> {
        let steps = (time_s - self.begin_s) / STEP_S;
        let (before, share) = (steps.floor(), steps.fract());
        if before < 0.0 {
            return None;
        }
        let before = before as usize;
        let (before, after) = (self.steps_rad.get(before)?, self.steps_rad.get(before + 1)?);
        Some(before + share * (after - before))
    }

    /// What the gyroscope leaves of turns that come so late, as a share of their squares; the
    /// bias of its rate and how it is inclined are those that leave the least.
    fn left(&self, turns: &[Turn], late_s: f64) -> Option<f64> {
        let (mut n, mut x, mut y) = (0.0, 0.0, 0.0);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for turn in turns {
            let (from, to) = (self.at(turn.from_s - late_s), self.at(turn.to_s - late_s));
            let Some((from, to)) = from.zip(to) else {
                continue;
            };
            let (by, seen) = (to - from, turn.by_rad);
            n += 1.0;
            (x, y) = (x + by, y + seen);
            (xx, xy, yy) = (xx + by * by, xy + by * seen, yy + seen * seen);
        }
        let (xx, xy, yy) = (n * xx - x * x, n * xy - x * y, n * yy - y * y);
        // Most of them have to be known at both times.
        (2.0 * n > turns.len() as f64 && xx > 0.0 && yy > 0.0)
            .then(|| 1.0 - xy.max(0.0) * xy / (xx * yy))
    }
}
