//! Whether an airspeed has stepped, as neither an aircraft nor the air does.

use fcc_core::blocks::LowPass;

/// The lag of what the sensor showed before, s. A gust of 15 m/s that comes in 1 s
/// as 1 - cos (MIL-F-8785C, 3.7.3.4) is 2.4 m/s beyond it at most.
const BEFORE_LAG_S: f64 = 0.1;
/// A step: beyond what was before by this share of the reference airspeed (8 kt of
/// 100 kt), and by this at least, m/s, for this time, s: a single reading of a sensor
/// of 10 Hz that is wrong lasts 0.1 s.
const STEP_RATIO: f64 = 0.08;
const LEAST_STEP_MPS: f64 = 4.0;
const STEPPED_FOR_S: f64 = 0.3;

/// Follows the sensor, and does not follow a step.
#[derive(Clone, Debug)]
pub(super) struct StepDetector {
    limit_mps: f64,
    before: Option<LowPass>,
    beyond_s: f64,
}

impl StepDetector {
    pub(super) const fn new(reference_mps: f64) -> Self {
        Self {
            limit_mps: (STEP_RATIO * reference_mps).max(LEAST_STEP_MPS),
            before: None,
            beyond_s: 0.0,
        }
    }

    /// Begins anew with the next reading.
    pub(super) const fn reset(&mut self) {
        self.before = None;
        self.beyond_s = 0.0;
    }

    /// The airspeed from which it has just stepped, m/s.
    pub(super) fn step(&mut self, sensor_mps: f64, dt_s: f64) -> Option<f64> {
        let before = self.before.get_or_insert_with(|| {
            let mut before = LowPass::new(BEFORE_LAG_S);
            before.reset(sensor_mps);
            before
        });
        let was_mps = before.output();
        if (sensor_mps - was_mps).abs() < self.limit_mps {
            before.step(sensor_mps, dt_s);
            self.beyond_s = 0.0;
            return None;
        }
        self.beyond_s += dt_s;
        if self.beyond_s < STEPPED_FOR_S {
            return None;
        }
        self.reset();
        Some(was_mps)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 0.025;

    /// The airspeed before the step that is seen in 10 s of an airspeed by time.
    fn steps(airspeed_mps: impl Fn(f64) -> f64) -> Option<f64> {
        let mut detector = StepDetector::new(51.4);
        (0..400).find_map(|tick| detector.step(airspeed_mps(f64::from(tick) * DT_S), DT_S))
    }

    /// The discrete gust of MIL-F-8785C, 3.7.3.4: 1 - cos.
    #[test]
    fn a_gust_is_no_step() {
        let share = |at_s: f64| 0.5 - 0.5 * libm::cos(core::f64::consts::PI * at_s);
        assert_eq!(
            steps(|at_s| 51.0 + 15.0 * share((at_s - 5.0).clamp(0.0, 1.0))),
            None
        );
        // Nor a dive: 1 g along the path.
        assert_eq!(steps(|at_s| 51.0 + 9.8 * (at_s - 5.0).max(0.0)), None);
    }

    #[test]
    fn a_wrong_reading_is_no_step() {
        assert_eq!(
            steps(|at_s| if (5.0..5.1).contains(&at_s) {
                90.0
            } else {
                51.0
            }),
            None
        );
    }

    #[test]
    fn a_step_is_seen() {
        assert_eq!(
            steps(|at_s| if at_s < 5.0 { 51.0 } else { 57.0 }),
            Some(51.0)
        );
    }
}
