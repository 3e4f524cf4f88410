//! Height above the ground by a range finder that is compared with the altitude.

use libm::fabs;

/// The elevation of the ground is followed with this time constant, s.
const FOLLOWS_S: f64 = 3.0;
/// A range fits if its ground is no farther than this from the one that is followed, m.
/// One that stays the same on a glide path of 3° at 70 kt leaves that within a second.
const FITS_M: f64 = 1.5;
/// Ranges are used after they have fitted for so long, s.
const SETTLES_S: f64 = 3.0;
/// On the wheels it is no farther than this from what it shows there, m.
const STANDS_OFF_M: f64 = 1.0;
/// For so long the height goes on by the altitude alone, s.
const BRIDGES_S: f64 = 2.0;

/// The ground below, as ranges and altitudes show it.
///
/// Each range and the altitude give an elevation of the ground, which changes slowly
/// over a runway and its approach. A range that jumps, or stays where it was while the
/// aircraft descends, gives another one: it is not used, and the height goes on by the
/// altitude for two seconds. Ranges from other ground are used when they have fitted
/// together for three.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct GroundBelow {
    elevation_m: f64,
    /// For how long ranges have fitted, s.
    fits_s: f64,
    /// For how long none has since then, s.
    lost_s: f64,
    /// Whether it showed the ground, and showed it wrong on the wheels.
    shows: bool,
    is_wrong: bool,
}

impl GroundBelow {
    /// Whether it has shown the ground.
    pub(super) const fn shows(&self) -> bool {
        self.shows
    }

    /// It is not expected to show the ground, until it does again.
    pub(super) const fn expect_nothing(&mut self) {
        self.shows = false;
    }

    /// Its ranges are not used any more, until it shows the right height on the wheels.
    pub(super) const fn leave(&mut self) {
        self.is_wrong = true;
    }

    /// The aircraft stands: the height that is right then is `on_wheels_m`. Whether it
    /// shows another one, and did not before.
    pub(super) fn stand(&mut self, height_m: Option<f64>, on_wheels_m: f64) -> bool {
        let was_wrong = self.is_wrong;
        if let Some(height_m) = height_m {
            self.is_wrong = fabs(height_m - on_wheels_m) > STANDS_OFF_M;
        }
        self.is_wrong && !was_wrong
    }

    /// The altitude, m, is another one from now on, because the altimeter was wrong: not
    /// the ground has left the one that ranges have shown.
    pub(super) fn adopt(&mut self, altitude_m: f64, height_m: Option<f64>) {
        if let Some(height_m) = height_m {
            self.elevation_m = altitude_m - height_m;
        }
    }

    /// `dt_s` seconds pass, at an altitude, m, that has `stepped_m` in them, with a height
    /// by the range finder, m. The height above ground, m, if there is one.
    pub(super) fn step(
        &mut self,
        altitude_m: f64,
        stepped_m: f64,
        height_m: Option<f64>,
        dt_s: f64,
    ) -> Option<f64> {
        self.elevation_m += stepped_m;
        let height_m = height_m.filter(|height_m| !self.is_wrong && *height_m >= 0.0);
        let is_settled = self.fits_s >= SETTLES_S;
        self.shows |= is_settled;
        let off_m = height_m.map(|height_m| altitude_m - height_m - self.elevation_m);
        match off_m {
            Some(off_m) if fabs(off_m) <= FITS_M => {
                self.elevation_m += off_m * (dt_s / FOLLOWS_S).min(1.0);
                self.fits_s += dt_s;
                self.lost_s = 0.0;
                return height_m.filter(|_| is_settled);
            }
            _ if is_settled && self.lost_s < BRIDGES_S => self.lost_s += dt_s,
            _ => {
                self.elevation_m = altitude_m - height_m.unwrap_or(0.0);
                (self.fits_s, self.lost_s) = (0.0, 0.0);
            }
        }
        (self.fits_s >= SETTLES_S).then_some(altitude_m - self.elevation_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;
    /// A descent of 3° at 70 kt, m/s: 371 ft/min.
    const SINK_MPS: f64 = 1.885;

    /// Descends from 38 m above ground at 120 m with ranges that `of` makes of the time, s,
    /// and of the true height, m; the heights that come out, each beside the true one.
    fn descend(of: impl Fn(f64, f64) -> Option<f64>) -> std::vec::Vec<(f64, Option<f64>)> {
        let mut ground = GroundBelow::default();
        (0..800)
            .map(|tick| {
                let t_s = f64::from(tick) * DT_S;
                let true_m = 38.0 - SINK_MPS * t_s;
                // Altimeter 6 m too high.
                (
                    true_m,
                    ground.step(126.0 + true_m, 0.0, of(t_s, true_m), DT_S),
                )
            })
            .take_while(|(true_m, _)| *true_m > 0.0)
            .collect()
    }

    #[test]
    fn ranges_that_fit_are_the_height_after_three_seconds() {
        let heights = descend(|_, true_m| Some(true_m));
        let first = heights.iter().position(|(_, height)| height.is_some());
        assert!(
            first.is_some_and(|tick| (119..=122).contains(&tick)),
            "{first:?}"
        );
        let off = |&(true_m, height_m): &(f64, Option<f64>)| height_m.is_some_and(|h| h != true_m);
        assert!(!heights.iter().any(off));
    }

    #[test]
    fn one_that_is_stuck_is_not_used() {
        for stuck_m in [0.0, 1.3, 12.0, 40.0] {
            let heights = descend(|_, _| Some(stuck_m));
            assert!(
                heights.iter().all(|(_, height)| height.is_none()),
                "{stuck_m}"
            );
        }
    }

    /// A leaf, a drop-out, an echo: the altitude bridges them to half a metre.
    #[test]
    fn jumps_and_gaps_are_bridged() {
        for wrong in [Some(0.1), None, Some(39.0)] {
            let heights = descend(|t_s, true_m| {
                if (10.0..11.5).contains(&t_s) {
                    wrong
                } else {
                    Some(true_m)
                }
            });
            for (true_m, height_m) in &heights[122..] {
                assert!(
                    (height_m.unwrap() - true_m).abs() < 0.5,
                    "{wrong:?} {true_m}"
                );
            }
        }
    }

    #[test]
    fn one_that_is_wrong_on_the_wheels_is_not_used() {
        let mut ground = GroundBelow::default();
        assert!(ground.stand(Some(-3.4), 1.3) && !ground.stand(Some(-3.4), 1.3));
        for _ in 0..200 {
            assert_eq!(ground.step(126.0, 0.0, Some(4.0), DT_S), None);
        }
        assert!(!ground.stand(Some(1.4), 1.3));
        let shown = (0..200).filter_map(|_| ground.step(126.0, 0.0, Some(4.0), DT_S));
        assert_eq!(shown.last(), Some(4.0));
    }

    /// Stuck in the flare: the height does not follow it for long.
    #[test]
    fn one_that_sticks_on_the_way_is_left() {
        let heights = descend(|t_s, true_m| Some(if t_s < 10.0 { true_m } else { 19.15 }));
        let after = |s: usize| heights[s * 40].1;
        // Farther off than the limit after 0.9 s, and bridged from there.
        assert!(after(12).unwrap() < 19.15 - 1.5);
        assert_eq!(after(14), None);
    }
}
