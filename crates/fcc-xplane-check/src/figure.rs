//! A measured number and its limit.

use serde::Serialize;

/// A measured number and its limit.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Figure {
    /// What was measured.
    pub name: String,
    /// The number; none if it could not be measured.
    pub value: Option<f64>,
    /// Its unit.
    pub unit: &'static str,
    /// The limit in words; none if it is only noted.
    pub limit: Option<String>,
    /// Whether the number is within its limit.
    pub within: bool,
}

/// The limit of a figure.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Limit {
    AtMost(f64),
    AtLeast(f64),
    Between(f64, f64),
    /// No limit: for the reader of the report.
    Noted,
}

impl Figure {
    pub(crate) fn new(name: &str, value: f64, unit: &'static str, limit: Limit) -> Self {
        let (within, limit) = match limit {
            Limit::AtMost(most) => (value <= most, Some(format!("at most {most}"))),
            Limit::AtLeast(least) => (value >= least, Some(format!("at least {least}"))),
            Limit::Between(least, most) => (
                (least..=most).contains(&value),
                Some(format!("{least} to {most}")),
            ),
            Limit::Noted => (true, None),
        };
        Self {
            name: name.to_owned(),
            value: value.is_finite().then_some(value),
            unit,
            limit,
            within,
        }
    }

    /// The number with its unit.
    pub fn text(&self) -> String {
        match self.value {
            Some(value) if value.abs() >= 1_000.0 => format!("{value:.0} {}", self.unit),
            Some(value) => format!("{value:.3} {}", self.unit),
            None => "not measured".to_owned(),
        }
        .trim_end()
        .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_could_not_be_measured_is_within_no_limit() {
        for limit in [
            Limit::AtMost(1.0),
            Limit::AtLeast(1.0),
            Limit::Between(0.0, 1.0),
        ] {
            let figure = Figure::new("bank", f64::NAN, "°", limit);
            assert!(!figure.within, "{limit:?}");
            assert_eq!(figure.text(), "not measured");
        }
    }
}
