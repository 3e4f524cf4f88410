//! Two flights in figures, a sentence for each.

use serde_json::{Value, json};

use super::summary::Summary;

/// A figure: its name in a summary; in words, its unit, digits; the words for more and less
/// of it.
type Figure = (&'static str, (&'static str, &'static str, usize), Words);
type Words = (&'static str, &'static str);

const LONGER: Words = ("longer", "shorter");
const LARGER: Words = ("larger", "smaller");
const HIGHER: Words = ("higher", "lower");
const MORE: Words = ("more", "fewer");

const FIGURES: [Figure; 12] = [
    ("engaged_s", ("time engaged", "s", 0), LONGER),
    ("distance_m", ("distance flown", "m", 0), LONGER),
    (
        "cross_track_rms_m",
        ("distance from the path, RMS", "m", 1),
        LARGER,
    ),
    (
        "airspeed_rms_mps",
        ("airspeed off its set point, RMS", "m/s", 1),
        LARGER,
    ),
    ("highest_altitude_m", ("highest altitude", "m", 0), HIGHER),
    (
        "greatest_airspeed_mps",
        ("greatest airspeed", "m/s", 1),
        HIGHER,
    ),
    ("greatest_bank_deg", ("greatest bank", "degrees", 1), LARGER),
    (
        "greatest_load_factor",
        ("greatest load factor", "g", 2),
        LARGER,
    ),
    ("go_arounds", ("go-arounds", "", 0), MORE),
    ("failsafes", ("failsafes", "", 0), MORE),
    (
        "lateness_p99_us",
        ("lateness of 99 % of the ticks", "µs", 1),
        LONGER,
    ),
    ("missed", ("missed periods", "", 0), MORE),
];

/// The figures of two flights, and how the second differs.
pub(super) fn differences(a: &Summary, b: &Summary) -> Value {
    let rows = FIGURES.iter().filter_map(|figure| {
        let (name, (what, unit, _), _) = figure;
        let (a, b) = (a.figures.get(*name), b.figures.get(*name));
        if a.is_none() && b.is_none() {
            return None;
        }
        Some(json!({
            "what": what,
            "a": a,
            "b": b,
            "unit": unit,
            "sentence": sentence(figure, a.copied(), b.copied()),
        }))
    });
    rows.collect()
}

fn sentence(figure: &Figure, a: Option<f64>, b: Option<f64>) -> String {
    let (_, (what, unit, digits), (more, less)) = figure;
    let (Some(a), Some(b)) = (a, b) else {
        let which = if a.is_some() { "first" } else { "second" };
        return format!("Only of the {which} flight the {what} is known.");
    };
    let shown = format!("{:.*}", digits, (b - a).abs());
    // As large as what is shown.
    if shown.parse() == Ok(0.0_f64) {
        return if unit.is_empty() {
            format!("Both flights have the same number of {what}.")
        } else {
            format!("The {what} is the same.")
        };
    }
    let word = if b > a { more } else { less };
    if unit.is_empty() {
        return format!("The second flight has {shown} {word} {what}.");
    }
    format!("In the second flight the {what} is {shown} {unit} {word}.")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flight(figures: &[(&str, f64)]) -> Summary {
        let mut summary = Summary::default();
        let figures = figures.iter();
        summary.figures = figures
            .map(|(name, value)| ((*name).to_owned(), *value))
            .collect();
        summary
    }

    #[test]
    fn a_sentence_says_which_way_the_second_differs() {
        let a = flight(&[
            ("distance_m", 12_000.0),
            ("missed", 3.0),
            ("cross_track_rms_m", 2.04),
        ]);
        let b = flight(&[
            ("distance_m", 11_400.0),
            ("missed", 5.0),
            ("cross_track_rms_m", 2.0),
            ("engaged_s", 9.0),
        ]);
        let rows = differences(&a, &b);
        let sentences: Vec<&str> = rows
            .as_array()
            .unwrap()
            .iter()
            .map(|row| row["sentence"].as_str().unwrap())
            .collect();
        assert_eq!(
            sentences,
            [
                "Only of the second flight the time engaged is known.",
                "In the second flight the distance flown is 600 m shorter.",
                "The distance from the path, RMS is the same.",
                "The second flight has 2 more missed periods.",
            ]
        );
    }
}
