//! Gusts against MIL-F-8785C (1980), 3.7: standard deviations, correlation
//! over a scale length, and the roll gust's spectrum, over long flights.

use fcc_sim::Severity;
use fcc_sim::turbulence::{Dryden, Gust};
use fcc_sim::units::FOOT_M;

const SPAN_M: f64 = 36.0 * FOOT_M;
const SPEED_MPS: f64 = 53.0;

/// Gusts along a flight of `steps`.
fn gusts(severity: Severity, height_ft: f64, dt_s: f64, steps: usize) -> Vec<Gust> {
    let mut dryden = Dryden::new(severity, 7);
    (0..steps)
        .map(|_| dryden.step(dt_s, SPEED_MPS, height_ft * FOOT_M, SPAN_M))
        .collect()
}

fn sigma(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Correlation at a lag of `lag` steps.
fn correlation(values: &[f64], lag: usize) -> f64 {
    let pairs = values.iter().zip(values.iter().skip(lag));
    let products: f64 = pairs.map(|(a, b)| a * b).sum();
    products / (values.len() - lag) as f64 / sigma(values).powi(2)
}

fn assert_near(value: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (value - expected).abs() <= tolerance,
        "{what}: {value:.4}, expected {expected:.4}"
    );
}

/// 3,000 ft, moderate: figure 7 gives 10.2 ft/s between 9.6 at 1,750 and 10.6
/// at 3,750 ft; all scale lengths are 1,750 ft. Steps of 1/4 length, so that
/// the flight is some thousand lengths long.
#[test]
fn at_3000_ft_sigma_and_scale_agree_with_the_specification() {
    const PER_LENGTH: usize = 4;
    let length_m = 1750.0 * FOOT_M;
    let dt_s = length_m / SPEED_MPS / PER_LENGTH as f64;
    let gusts = gusts(Severity::Moderate, 3_000.0, dt_s, 120_000);
    for axis in 0..3 {
        let values: Vec<f64> = gusts.iter().map(|gust| gust.velocity_mps[axis]).collect();
        assert_near(sigma(&values) / (10.225 * FOOT_M), 1.0, 0.02, "sigma");
        // The transforms of the spectra: e^-r along, (1 - r/2)·e^-r across.
        for lengths in [0.25, 0.5, 1.0, 2.0_f64] {
            let lag = (lengths * PER_LENGTH as f64) as usize;
            let shape = if axis == 0 { 1.0 } else { 1.0 - lengths / 2.0 };
            let expected = shape * (-lengths).exp();
            assert_near(correlation(&values, lag), expected, 0.02, "correlation");
        }
    }
}

/// 500 ft, moderate, 30 kt at 20 ft, at the step the aircraft flies with:
/// σw = 0.1·W20 = 5.063 ft/s, σu = σw/0.5885^0.4 = 6.259 ft/s;
/// Lw = 500 ft, Lu = 500/0.5885^1.2 = 944.7 ft.
#[test]
fn at_500_ft_sigma_and_scale_agree_with_the_specification() {
    let dt_s = 1.0 / 120.0;
    let gusts = gusts(Severity::Moderate, 500.0, dt_s, 1_500_000);
    let axis =
        |axis: usize| -> Vec<f64> { gusts.iter().map(|gust| gust.velocity_mps[axis]).collect() };
    let (along, across, vertical) = (axis(0), axis(1), axis(2));
    assert_near(sigma(&along) / (6.259 * FOOT_M), 1.0, 0.05, "sigma u");
    assert_near(sigma(&across) / (6.259 * FOOT_M), 1.0, 0.05, "sigma v");
    assert_near(sigma(&vertical) / (5.063 * FOOT_M), 1.0, 0.03, "sigma w");
    let lag = |length_ft: f64| (length_ft * FOOT_M / SPEED_MPS / dt_s).round() as usize;
    let e = (-1.0_f64).exp();
    assert_near(correlation(&along, lag(944.7)), e, 0.05, "u");
    assert_near(correlation(&across, lag(944.7)), e / 2.0, 0.05, "v");
    assert_near(correlation(&vertical, lag(500.0)), e / 2.0, 0.05, "w");
}

/// The variance of the roll gust is the integral of its spectrum, Φp =
/// σw²/(V·Lw)·0.8·(π·Lw/4b)^⅓/(1 + (4bω/πV)²), integrated numerically here.
#[test]
fn the_roll_gust_has_its_spectrums_variance() {
    use std::f64::consts::PI;
    let gusts = gusts(Severity::Moderate, 3_000.0, 0.1, 200_000);
    let rolls: Vec<f64> = gusts.iter().map(|gust| gust.rates_radps.x).collect();
    let (sigma_w, length_m) = (10.225 * FOOT_M, 1750.0 * FOOT_M);
    let spectrum = |omega: f64| {
        let corner = 4.0 * SPAN_M * omega / (PI * SPEED_MPS);
        sigma_w.powi(2) / (SPEED_MPS * length_m) * 0.8 * (PI * length_m / (4.0 * SPAN_M)).cbrt()
            / (1.0 + corner * corner)
    };
    let step = 0.01;
    let variance: f64 = (0..2_000_000)
        .map(|index| spectrum((f64::from(index) + 0.5) * step) * step)
        .sum();
    assert_near(sigma(&rolls) / variance.sqrt(), 1.0, 0.02, "sigma p");
}

/// A gust that increases along the flight path gives the air a nose-down and a
/// right turn rate: q = -∂w/∂x, r = ∂v/∂x, each behind a lag of 4b/π or 3b/π.
#[test]
fn pitch_and_yaw_gusts_follow_the_gradient() {
    let dt_s = 1.0 / 120.0;
    let gusts = gusts(Severity::Moderate, 3_000.0, dt_s, 100_000);
    let mut agreement = [0.0; 2];
    for pair in gusts.windows(60) {
        let (first, last) = (&pair[0], &pair[59]);
        let change = last.velocity_mps - first.velocity_mps;
        let turned: nalgebra::Vector3<f64> = pair.iter().map(|gust| gust.rates_radps).sum();
        agreement[0] -= change.z * turned.y;
        agreement[1] += change.y * turned.z;
    }
    assert!(agreement.iter().all(|sum| *sum > 0.0), "{agreement:?}");
}

/// Between 1,000 and 2,000 ft the two models are interpolated linearly.
#[test]
fn the_models_are_continuous() {
    for severity in [Severity::Light, Severity::Moderate, Severity::Severe] {
        for height_ft in [1_000.0, 2_000.0] {
            let below = severity.scales((height_ft - 0.01) * FOOT_M);
            let above = severity.scales((height_ft + 0.01) * FOOT_M);
            assert_near(
                below.horizontal_sigma_mps,
                above.horizontal_sigma_mps,
                1e-3,
                "sigma",
            );
            assert_near(
                below.vertical_length_m,
                above.vertical_length_m,
                0.02,
                "length",
            );
        }
    }
    let high = Severity::Severe.scales(7_500.0 * FOOT_M);
    assert_near(high.vertical_sigma_mps, 23.6 * FOOT_M, 1e-9, "figure 7");
    let highest = Severity::Light.scales(60_000.0 * FOOT_M);
    assert_near(highest.vertical_sigma_mps, 0.0, 1e-12, "above the figure");
}
