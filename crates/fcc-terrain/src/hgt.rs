//! SRTM's `.hgt`.

use std::io::{self, Read};
use std::ops::Range;

use crate::lattice::Lattice;

/// Posts of a side: 1 and 3 seconds of arc.
const SIDES: [usize; 2] = [3_601, 1_201];
/// A height that is none.
const VOID: i16 = -32_768;

/// A tile that was read.
#[derive(Debug)]
pub(crate) struct Hgt {
    pub(crate) lattice: Lattice,
    bytes: Vec<u8>,
}

/// The south-west corner that a name says, in degrees of latitude and longitude.
pub(crate) fn corner(name: &str) -> Option<(f64, f64)> {
    let degrees = |letter: usize, digits: Range<usize>, signs: [char; 2], most: i16| {
        let letter = name.get(letter..=letter)?.chars().next()?;
        let sign = signs
            .iter()
            .position(|sign| letter.eq_ignore_ascii_case(sign))?;
        let digits = name.get(digits)?;
        let is_number = digits.bytes().all(|digit| digit.is_ascii_digit());
        let number: i16 = digits.parse().ok().filter(|_| is_number)?;
        let degrees = if sign == 0 { number } else { -number };
        (-most..most).contains(&degrees).then(|| f64::from(degrees))
    };
    let latitude = degrees(0, 1..3, ['N', 'S'], 90)?;
    let longitude = degrees(3, 4..7, ['E', 'W'], 180)?;
    // What follows is not another digit of it.
    name.get(7..)?
        .starts_with('.')
        .then_some((latitude, longitude))
}

impl Hgt {
    /// Reads a tile with this south-west corner.
    pub(crate) fn read(
        (south_deg, west_deg): (f64, f64),
        from: impl Read,
    ) -> Result<Result<Self, String>, io::Error> {
        let most = SIDES[0] * SIDES[0] * 2;
        let mut bytes = Vec::new();
        from.take(most as u64 + 1).read_to_end(&mut bytes)?;
        let Some(side) = SIDES
            .into_iter()
            .find(|side| side * side * 2 == bytes.len())
        else {
            let sizes = SIDES.map(|side| (side * side * 2).to_string()).join(" or ");
            let has = if bytes.len() > most {
                "more".to_owned()
            } else {
                bytes.len().to_string()
            };
            return Ok(Err(format!(
                "has {has} bytes, and a tile of 1 or 3 seconds of arc has {sizes}: fetch it again"
            )));
        };
        let per_degree = side as f64 - 1.0;
        Ok(Ok(Self {
            lattice: Lattice {
                north_deg: south_deg + 1.0,
                west_deg,
                posts_per_degree: [per_degree, per_degree],
                rows: side,
                columns: side,
            },
            bytes,
        }))
    }

    /// The height of a post, m; not a number for a void.
    pub(crate) fn height_m(&self, row: usize, column: usize) -> f32 {
        let at = 2 * (row * self.lattice.columns + column);
        match self.bytes.get(at..at + 2) {
            Some(&[high, low]) => match i16::from_be_bytes([high, low]) {
                VOID => f32::NAN,
                height_m => f32::from(height_m),
            },
            _ => f32::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::corner;

    #[test]
    fn a_name_is_that_of_the_south_west_corner() {
        assert_eq!(corner("N47E008.hgt"), Some((47.0, 8.0)));
        assert_eq!(corner("s01w180.SRTMGL1.hgt"), Some((-1.0, -180.0)));
        for name in [
            "N47E08.hgt",
            "N47E0080.hgt",
            "N90E008.hgt",
            "X47E008.hgt",
            "N47E180.hgt",
            "N+7E008.hgt",
            "N4ä008.hgt",
            "",
        ] {
            assert_eq!(corner(name), None, "{name}");
        }
    }
}
