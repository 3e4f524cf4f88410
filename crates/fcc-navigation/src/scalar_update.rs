//! Kalman filters that are corrected by one scalar measurement at a time.

/// A state or its covariance's row.
pub(super) type State<const N: usize> = [f64; N];
pub(super) type Covariance<const N: usize> = [State<N>; N];

pub(super) fn squared(x: f64) -> f64 {
    x * x
}

/// The correction by a scalar measurement (Gelb 1974, table 4.2-1).
pub(super) fn update<const N: usize>(
    x: &mut State<N>,
    covariance: &mut Covariance<N>,
    h: State<N>,
    by: f64,
    variance: f64,
) {
    let ph = covariance.map(|row| dot(row, h));
    let per = 1.0 / (dot(ph, h) + variance);
    for ((row, x), gain) in covariance.iter_mut().zip(x).zip(ph) {
        *x += gain * by * per;
        for (p, other) in row.iter_mut().zip(ph) {
            *p -= gain * other * per;
        }
    }
}

/// The variance of a measurement's prediction.
pub(super) fn variance<const N: usize>(covariance: &Covariance<N>, h: State<N>) -> f64 {
    dot(covariance.map(|row| dot(row, h)), h)
}

/// Adds to the variances of a state.
pub(super) fn add_variance<const N: usize>(covariance: &mut Covariance<N>, variance: State<N>) {
    for (place, (row, more)) in covariance.iter_mut().zip(variance).enumerate() {
        if let Some(own) = row.get_mut(place) {
            *own += more;
        }
    }
}

fn dot<const N: usize>(a: State<N>, b: State<N>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
