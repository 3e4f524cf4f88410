//! Lists of a fixed length. serde reads the first entries of a longer list and
//! leaves the others out.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

/// Reads a list of exactly `N` numbers.
pub(super) fn numbers<'de, D, const N: usize>(from: D) -> Result<[f64; N], D::Error>
where
    D: Deserializer<'de>,
{
    let given = Vec::<f64>::deserialize(from)?;
    given.try_into().map_err(|given: Vec<f64>| {
        D::Error::custom(format_args!(
            "has {} numbers: choose exactly {N}",
            given.len()
        ))
    })
}

/// The same of a key that may be left out.
pub(super) fn numbers_if_given<'de, D, const N: usize>(
    from: D,
) -> Result<Option<[f64; N]>, D::Error>
where
    D: Deserializer<'de>,
{
    numbers(from).map(Some)
}

#[cfg(test)]
mod tests {
    use toml::Value;

    use crate::config::values::keyed;
    use crate::config::{BuiltInSection, CalibrationSection, Config};

    /// A configuration in which every list of numbers is given.
    fn with_all_lists() -> Config {
        let mut calibration = CalibrationSection::default();
        calibration.gnss.delay_ms = 1.0;
        let built_in = BuiltInSection {
            calibration,
            ..BuiltInSection::default()
        };
        let mut config = Config {
            built_in: Some(built_in),
            ..Config::default()
        };
        config.navigation.magnetic_field_ut = Some([21.1, 0.0, 45.3]);
        config
    }

    #[test]
    fn a_list_with_a_number_too_many_or_too_few_is_refused() {
        let config = with_all_lists();
        let values = config.values().unwrap();
        let lists = keyed(&values).into_iter().filter_map(|(key, value)| {
            let list = value.as_array()?;
            list.first()?.as_float()?;
            Some((key, list.clone()))
        });
        let mut keys = 0;
        for (key, list) in lists {
            for change in [1, -1] {
                let mut other = list.clone();
                if change > 0 {
                    other.push(list[0].clone());
                } else {
                    other.pop();
                }
                let given = other.len();
                let refused = config.with_values([(&*key, Value::Array(other))]);
                assert_eq!(
                    refused.unwrap_err().to_string(),
                    format!(
                        "config: {key}: has {given} numbers: choose exactly {}",
                        list.len()
                    )
                );
            }
            keys += 1;
        }
        // Rotation, bias, scale and misalignment of three sensors, and the field.
        assert_eq!(keys, 13);
    }
}
