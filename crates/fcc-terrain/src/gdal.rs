//! What GDAL says about the values of a band, in the tags `GDAL_METADATA` and
//! `GDAL_NODATA` (GDAL, the driver "`GTiff`").

/// How a value of a band is a height.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Values {
    /// The value that is none.
    pub(crate) nodata: Option<f64>,
    scale: f64,
    offset: f64,
    /// m in the unit.
    unit_m: f64,
}

/// The unit of heights, by its name.
fn unit_m(name: &str) -> Option<f64> {
    match name.to_ascii_lowercase().as_str() {
        "" | "m" | "metre" | "metres" | "meter" | "meters" => Some(1.0),
        "ft" | "foot" | "feet" => Some(0.304_8),
        "us-ft" | "ft-us" | "us survey foot" | "us_survey_foot" => Some(1_200.0 / 3_937.0),
        "cm" => Some(0.01),
        "mm" => Some(0.001),
        _ => None,
    }
}

impl Values {
    /// By both tags, and the unit of the keys, which the first overrides.
    pub(crate) fn of(nodata: Option<&str>, metadata: &str, keys_m: f64) -> Result<Self, String> {
        let number = |name: &str, text: &str| {
            let text = text.trim_matches(['\0', ' ']);
            let number = text.parse::<f64>();
            number.map_err(|_| format!("its {name} is no number: {text:.20}"))
        };
        let role = |role: &str, other: f64| {
            let found = item(metadata, role).map(|text| number(role, text));
            let found = found.transpose()?.unwrap_or(other);
            if found.is_finite() {
                Ok(found)
            } else {
                Err(format!("its {role} is {found}"))
            }
        };
        let unit_m = match item(metadata, "unittype").map(str::trim) {
            None => keys_m,
            Some(name) => unit_m(name).ok_or_else(|| {
                format!("its heights are in the unit \"{name:.20}\": give them in m or ft")
            })?,
        };
        Ok(Self {
            nodata: nodata.map(|text| number("GDAL_NODATA", text)).transpose()?,
            scale: role("scale", 1.0).and_then(|scale| match scale {
                0.0 => Err("its scale is 0".to_owned()),
                scale => Ok(scale),
            })?,
            offset: role("offset", 0.0)?,
            unit_m,
        })
    }

    /// The height of a value, m; not a number where it is none.
    pub(crate) fn height_m(&self, value: f64) -> f32 {
        match self.nodata {
            // A void of 32 bits is written with more digits than it has.
            Some(nodata) if value == nodata || value as f32 == nodata as f32 => f32::NAN,
            _ => ((value * self.scale + self.offset) * self.unit_m) as f32,
        }
    }
}

/// The text of the first band's item with a role, of the XML in `GDAL_METADATA`.
fn item<'a>(metadata: &'a str, role: &str) -> Option<&'a str> {
    let items = metadata.split("<Item ").skip(1);
    items
        .filter_map(|item| item.split_once('>'))
        .find(|(attributes, _)| {
            let has = |name: &str, value: &str| {
                ['"', '\'']
                    .iter()
                    .any(|quote| attributes.contains(&format!("{name}={quote}{value}{quote}")))
            };
            has("role", role) && (has("sample", "0") || !attributes.contains("sample="))
        })
        .and_then(|(_, text)| text.split_once('<'))
        .map(|(text, _)| text)
}

#[cfg(test)]
mod tests {
    use super::Values;

    fn of(items: &str) -> Result<f32, String> {
        let metadata = format!("<GDALMetadata>\n{items}\n</GDALMetadata>\n\0");
        Values::of(Some("-1\0"), &metadata, 1.0).map(|values| values.height_m(60.0))
    }

    #[test]
    fn scale_offset_and_unit_make_the_height() {
        assert_eq!(of(""), Ok(60.0));
        let scale = r#"  <Item name="SCALE" sample="0" role="scale">10</Item>"#;
        assert_eq!(of(scale), Ok(600.0));
        let offset = r"<Item role='offset' sample='0' name='OFFSET'>-20</Item>";
        assert_eq!(of(&format!("{offset}{scale}")), Ok(580.0));
        // Those of other bands are none of ours.
        assert_eq!(of(&scale.replace("\"0\"", "\"1\"")), Ok(60.0));
        let unit = |name: &str| {
            format!(r#"<Item name="UNITTYPE" sample="0" role="unittype">{name}</Item>"#)
        };
        assert_eq!(of(&unit("metre")), Ok(60.0));
        // 1 ft is 0.3048 m, 1 US survey foot 1,200/3,937 m.
        assert_eq!(of(&unit("ft")), Ok(18.288));
        assert_eq!(of(&unit("US survey foot")), Ok(72_000.0 / 3_937.0));
        let said = of(&unit("fathom")).unwrap_err();
        assert!(
            said.starts_with("its heights are in the unit \"fathom\""),
            "{said}"
        );
        assert!(
            of(&scale.replace("10", "x"))
                .unwrap_err()
                .contains("scale is no number: x")
        );
        let void = Values::of(Some("60"), scale, 1.0).unwrap();
        assert!(void.height_m(60.0).is_nan() && void.height_m(6.0) == 60.0);
    }
}
