//! A point mass with roll dynamics in wind, and the figures that the law has to
//! reach with it.

use std::vec::Vec;

use nalgebra::Vector2;

use super::{BankCommand, Motion, Npfg, NpfgConfig, Path};

pub(crate) const KT: f64 = 1_852.0 / 3_600.0;
pub(crate) const DT_S: f64 = 0.01;
const MOST_BANK_DEG: f64 = 30.0;
const BANK_RATE_DEG: f64 = 15.0;

/// Flies at a constant airspeed: ψ̇ = g·tan φ/V, φ follows its command with a lag.
pub(crate) struct PointMass {
    pub(crate) position_m: Vector2<f64>,
    pub(crate) heading_rad: f64,
    bank_rad: f64,
    pub(crate) airspeed_mps: f64,
    wind_mps: Vector2<f64>,
    roll_tau_s: f64,
    bank: BankCommand,
}

impl PointMass {
    pub(crate) fn new(airspeed_kt: f64, wind_mps: Vector2<f64>, roll_tau_s: f64) -> Self {
        let (most, rate) = (MOST_BANK_DEG.to_radians(), BANK_RATE_DEG.to_radians());
        let mut bank = BankCommand::new(most, rate);
        bank.reset(0.0);
        Self {
            position_m: Vector2::zeros(),
            heading_rad: 0.0,
            bank_rad: 0.0,
            airspeed_mps: airspeed_kt * KT,
            wind_mps,
            roll_tau_s,
            bank,
        }
    }

    pub(crate) fn motion(&self) -> Motion {
        let heading = Vector2::new(self.heading_rad.cos(), self.heading_rad.sin());
        Motion {
            position_m: self.position_m,
            ground_velocity_mps: heading * self.airspeed_mps + self.wind_mps,
            wind_mps: self.wind_mps,
        }
    }

    /// One tick with an acceleration; returns the commanded bank.
    pub(crate) fn fly(&mut self, acceleration_mps2: f64) -> f64 {
        let command = self.bank.step(acceleration_mps2, DT_S);
        self.bank_rad += (command - self.bank_rad) * (1.0 - (-DT_S / self.roll_tau_s).exp());
        self.heading_rad += 9.806_65 * self.bank_rad.tan() / self.airspeed_mps * DT_S;
        self.position_m += self.motion().ground_velocity_mps * DT_S;
        command
    }

    /// Follows a path; cross-track errors, m, after `settle_s`.
    fn follow(&mut self, law: &mut Npfg, path: &Path, settle_s: f64, until_s: f64) -> Vec<f64> {
        let ticks = |seconds: f64| (seconds / DT_S) as usize;
        let mut errors = Vec::new();
        for tick in 0..ticks(until_s) {
            let acceleration = law.acceleration_mps2(path, &self.motion());
            self.fly(acceleration);
            if tick >= ticks(settle_s) {
                errors.push(path.nearest(self.position_m).cross_track_m);
            }
        }
        errors
    }
}

pub(crate) fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

pub(crate) fn wind(from_deg: i32, kt: f64) -> Vector2<f64> {
    let to = f64::from(from_deg + 180).to_radians();
    Vector2::new(to.cos(), to.sin()) * (kt * KT)
}

/// Issue: cross-track RMS at most 5 m in calm air and 10 m in 20 kt from any side.
/// Without turbulence and noise the law is far below, and has no steady error.
#[test]
fn a_line_is_held_in_any_wind() {
    let path = Path::line(Vector2::new(0.0, 100.0), Vector2::new(9_000.0, 100.0)).unwrap();
    let mut law = Npfg::new(NpfgConfig::default());
    for (from_deg, kt) in [
        (0, 0.0),
        (0, 20.0),
        (90, 20.0),
        (180, 20.0),
        (225, 20.0),
        (270, 20.0),
    ] {
        for roll_tau_s in [0.5, 1.0] {
            let mut aircraft = PointMass::new(100.0, wind(from_deg, kt), roll_tau_s);
            let errors = aircraft.follow(&mut law, &path, 60.0, 180.0);
            let rms = rms(&errors);
            assert!(rms < 0.5, "wind {from_deg} {kt} kt: {rms} m");
        }
    }
}

/// Issue: circles of 750 m and 1,000 m at 100 kt within 5 % of the radius in 15 kt,
/// with at most 30° of bank.
#[test]
fn circles_are_held_within_5_percent_in_15_kt() {
    let mut law = Npfg::new(NpfgConfig::default());
    for radius_m in [750.0, 1_000.0] {
        for clockwise in [true, false] {
            for roll_tau_s in [0.5, 1.0] {
                let path = Path::Circle {
                    centre_m: Vector2::new(0.0, 2_000.0),
                    radius_m,
                    clockwise,
                };
                let mut aircraft = PointMass::new(100.0, wind(250, 15.0), roll_tau_s);
                let errors = aircraft.follow(&mut law, &path, 180.0, 600.0);
                let worst = errors.iter().fold(0.0_f64, |most, e| most.max(e.abs()));
                assert!(worst < 0.05 * radius_m, "{radius_m} m: {worst} m");
            }
        }
    }
}

/// From any place, in any direction, a law comes to its path; on the way everything
/// is finite, and the command keeps its limits.
#[test]
fn comes_to_a_path_from_anywhere() {
    let paths = [
        Path::line(Vector2::new(0.0, 0.0), Vector2::new(1_000.0, 1_000.0)).unwrap(),
        Path::Circle {
            centre_m: Vector2::zeros(),
            radius_m: 800.0,
            clockwise: true,
        },
    ];
    let mut law = Npfg::new(NpfgConfig::default());
    for path in paths {
        for n in 0..12 {
            let mut aircraft = PointMass::new(100.0, wind(40 * n, 20.0), 0.5);
            let angle = f64::from(n) * 0.9;
            aircraft.heading_rad = 2.0 * angle;
            aircraft.position_m = Vector2::new(angle.cos(), angle.sin()) * f64::from(n * 400);
            let mut last = 0.0;
            for _ in 0..40_000 {
                let a = law.acceleration_mps2(&path, &aircraft.motion());
                assert!(a.is_finite());
                let command = aircraft.fly(a);
                assert!(command.abs() <= MOST_BANK_DEG.to_radians() + 1e-12);
                let rate_deg = (command - last).to_degrees() / DT_S;
                assert!(rate_deg.abs() <= BANK_RATE_DEG + 1e-6);
                last = command;
            }
            let error = path.nearest(aircraft.position_m).cross_track_m;
            assert!(error.abs() < 40.0, "{path:?} from {n}: {error}");
        }
    }
}
