//! The unit of a value, by the end of its name.

/// A name without its unit, and the unit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Named<'a> {
    /// The name before the unit: `airspeed` of `airspeed_mps`.
    pub quantity: &'a str,
    /// The unit; empty for a name that ends in none.
    pub unit: &'static str,
}

/// The ends of names and their units; of two that fit, the longer comes first.
const UNITS: [(&str, &str); 23] = [
    ("_per_m", "1/m"),
    ("_radps2", "rad/s²"),
    ("_radps", "rad/s"),
    ("_mps2", "m/s²"),
    ("_mps", "m/s"),
    ("_rad", "rad"),
    ("_deg", "°"),
    ("_hz", "Hz"),
    ("_ns", "ns"),
    ("_us", "µs"),
    ("_ut", "µT"),
    ("_ms", "ms"),
    ("_pa", "Pa"),
    ("_kg", "kg"),
    ("_nm", "N m"),
    ("_n", "N"),
    ("_m", "m"),
    ("_s", "s"),
    ("_c", "°C"),
    ("_k", "K"),
    ("_w", "W"),
    ("_v", "V"),
    ("_a", "A"),
];

/// A name and its unit.
///
/// ```
/// use fcc_core::framework::schema::unit;
///
/// let named = unit::of("climb_rate_mps");
/// assert_eq!((named.quantity, named.unit), ("climb_rate", "m/s"));
/// assert_eq!(unit::of("throttle").unit, "");
/// ```
pub const fn of(name: &str) -> Named<'_> {
    let mut rest: &[(&str, &'static str)] = &UNITS;
    while let [(end, unit), others @ ..] = rest {
        let whole = name.as_bytes();
        if whole.len() > end.len() {
            let at = whole.len() - end.len();
            let (_, found) = whole.split_at(at);
            if is_same(found, end.as_bytes()) {
                // An underscore begins there: not within a character.
                let (quantity, _) = name.split_at(at);
                return Named { quantity, unit };
            }
        }
        rest = others;
    }
    Named {
        quantity: name,
        unit: "",
    }
}

const fn is_same(mut one: &[u8], mut other: &[u8]) -> bool {
    while let ([a, one_rest @ ..], [b, other_rest @ ..]) = (one, other) {
        if *a != *b {
            return false;
        }
        (one, other) = (one_rest, other_rest);
    }
    one.len() == other.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_has_its_own_unit() {
        for (end, unit) in UNITS {
            let first = UNITS.iter().find(|(known, _)| end.ends_with(known));
            assert_eq!(first.map(|(_, unit)| *unit), Some(unit), "{end}");
        }
    }

    /// Found by fuzzing: the name in an answer to a command may be any text.
    #[test]
    fn a_name_of_other_letters_has_no_unit() {
        for name in ["°", "ü\u{98}", "\u{98}mps", "é_m\u{301}"] {
            let expected = Named {
                quantity: name,
                unit: "",
            };
            assert_eq!(of(name), expected);
        }
        assert_eq!(of("höhe_m").quantity, "höhe");
    }
}
