//! How a sensor is mounted in the aircraft.

use core::fmt;
use core::str::FromStr;

use fcc_core::flight::orientation::{EulerAngles, body_to_earth, quaternion_from_euler};

/// A direction of the aircraft along one of its axes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Direction {
    /// Body x.
    Forward,
    /// Against body x.
    Backward,
    /// Body y.
    Right,
    /// Against body y.
    Left,
    /// Body z.
    Down,
    /// Against body z.
    Up,
}

impl Direction {
    /// Every direction, and its name.
    pub const ALL: [(&'static str, Self); 6] = [
        ("forward", Self::Forward),
        ("backward", Self::Backward),
        ("right", Self::Right),
        ("left", Self::Left),
        ("down", Self::Down),
        ("up", Self::Up),
    ];

    /// The unit vector in body axes.
    const fn vector(self) -> [f64; 3] {
        match self {
            Self::Forward => [1.0, 0.0, 0.0],
            Self::Backward => [-1.0, 0.0, 0.0],
            Self::Right => [0.0, 1.0, 0.0],
            Self::Left => [0.0, -1.0, 0.0],
            Self::Down => [0.0, 0.0, 1.0],
            Self::Up => [0.0, 0.0, -1.0],
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::Right => "right",
            Self::Left => "left",
            Self::Down => "down",
            Self::Up => "up",
        }
    }
}

/// One of the 24 right-angled mountings, named after the directions in which
/// the sensor's x, y and z axes point in the aircraft: `right-backward-down` is
/// a sensor that is turned by 90° to the right. The third follows from the
/// other two, and is a check of them.
///
/// ```
/// use fcc_calibration::Mounting;
///
/// // The thesis' phone: under the aircraft, its screen (z) down and its top (y)
/// // forward.
/// let phone: Mounting = "left-forward-down".parse()?;
/// // It accelerates forward by 2 m/s².
/// assert_eq!(phone.rotation().turned([0.0, 2.0, -9.81]), [2.0, 0.0, -9.81]);
/// assert!("right-forward-down".parse::<Mounting>().is_err());
/// # Ok::<(), fcc_calibration::MountingError>(())
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Mounting {
    x: Direction,
    y: Direction,
}

/// Sensor axes are body axes.
impl Default for Mounting {
    fn default() -> Self {
        Self {
            x: Direction::Forward,
            y: Direction::Right,
        }
    }
}

impl Mounting {
    /// The mounting of which the sensor's x and y axes point in these
    /// directions; none if they are parallel.
    pub fn new(x: Direction, y: Direction) -> Option<Self> {
        let is_perpendicular = dot(x.vector(), y.vector()) == 0.0;
        is_perpendicular.then_some(Self { x, y })
    }

    /// All 24.
    pub fn all() -> impl Iterator<Item = Self> {
        let pairs = |(_, x)| Direction::ALL.map(|(_, y)| Self::new(x, y));
        Direction::ALL.into_iter().flat_map(pairs).flatten()
    }

    /// Where the sensor's z axis points.
    fn z(self) -> Direction {
        let z = cross(self.x.vector(), self.y.vector());
        let found = Direction::ALL.iter().find(|(_, at)| at.vector() == z);
        found.map_or(Direction::Down, |(_, at)| *at)
    }

    /// From sensor axes to body axes.
    pub fn rotation(self) -> Rotation {
        Rotation::of_axes([self.x, self.y, self.z()].map(Direction::vector))
    }
}

impl fmt::Display for Mounting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = [self.x, self.y, self.z()].map(Direction::name);
        write!(f, "{x}-{y}-{z}")
    }
}

/// Why a text is no mounting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum MountingError {
    /// It is not three directions.
    Words,
    /// It has capitals.
    Capitals(
        /// What is meant.
        Mounting,
    ),
    /// The first two are parallel.
    Parallel,
    /// The third is not that of a right-handed set of axes, as every sensor has.
    LeftHanded(
        /// The right-handed one with the same x and y axes.
        Mounting,
    ),
}

impl fmt::Display for MountingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words => f.write_str(
                "is not where the sensor's x, y and z axes point in the aircraft: choose three of \
                 forward, backward, right, left, down, up with hyphens, such as \
                 \"forward-right-down\"",
            ),
            Self::Capitals(mounting) => write!(f, "has capitals: choose \"{mounting}\""),
            Self::Parallel => f.write_str(
                "has parallel x and y axes: choose two directions at right angles, and the third",
            ),
            Self::LeftHanded(mounting) => write!(
                f,
                "is left-handed, which no sensor is: with these x and y axes choose \"{mounting}\""
            ),
        }
    }
}

impl core::error::Error for MountingError {}

impl FromStr for Mounting {
    type Err = MountingError;

    fn from_str(text: &str) -> Result<Self, MountingError> {
        let direction = |word: Option<&str>| {
            let mut all = Direction::ALL.iter();
            let is_meant =
                |(name, _): &&(&str, _)| word.is_some_and(|of| of.eq_ignore_ascii_case(name));
            all.find(is_meant).map(|(_, at)| *at)
        };
        let mut words = text.split('-');
        let [x, y, z] = [(); 3].map(|()| direction(words.next()));
        let (Some(x), Some(y), Some(z), None) = (x, y, z, words.next()) else {
            return Err(MountingError::Words);
        };
        let mounting = Self::new(x, y).ok_or(MountingError::Parallel)?;
        if mounting.z() != z {
            Err(MountingError::LeftHanded(mounting))
        } else if text.contains(char::is_uppercase) {
            Err(MountingError::Capitals(mounting))
        } else {
            Ok(mounting)
        }
    }
}

/// A rotation matrix, by rows.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rotation(pub [[f64; 3]; 3]);

impl Rotation {
    /// No rotation.
    pub const NONE: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// The rotation of axes that are turned as an aircraft is: first by the
    /// heading about down, then by the pitch about right, then by the roll about
    /// forward. A sensor whose nose is 2° above the aircraft's has a pitch of 2°.
    pub fn of_angles(angles: EulerAngles) -> Self {
        let attitude = quaternion_from_euler(angles);
        Self::of_axes(Self::NONE.0.map(|axis| body_to_earth(attitude, axis)))
    }

    /// The rotation that takes x, y and z to these axes.
    const fn of_axes([x, y, z]: [[f64; 3]; 3]) -> Self {
        let ([a, b, c], [d, e, f], [g, h, i]) = (x, y, z);
        Self([[a, d, g], [b, e, h], [c, f, i]])
    }

    /// A vector, rotated.
    pub fn turned(&self, vector: [f64; 3]) -> [f64; 3] {
        self.0.map(|row| dot(row, vector))
    }

    /// The rotation `first`, then this one.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let columns = Self::of_axes(first.0).0.map(|column| self.turned(column));
        Self::of_axes(columns)
    }
}

fn dot([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> f64 {
    ax * bx + ay * by + az * bz
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString;
    use std::vec::Vec;

    use super::*;

    fn determinant(Rotation([x, y, z]): &Rotation) -> f64 {
        dot(*x, cross(*y, *z))
    }

    /// The rotations of the cube are a group of 24 (Coxeter 1973, section 3.5).
    #[test]
    fn right_angled_mountings_are_the_rotations_of_the_cube() {
        let all: Vec<Rotation> = Mounting::all().map(Mounting::rotation).collect();
        assert_eq!(all.len(), 24);
        for (at, one) in all.iter().enumerate() {
            assert_eq!(determinant(one), 1.0);
            assert!(!all[..at].contains(one), "{one:?} twice");
            for other in &all {
                assert!(all.contains(&one.after(other)), "{one:?} after {other:?}");
            }
        }
        assert!(all.contains(&Rotation::NONE));
    }

    #[test]
    fn each_has_its_name() {
        for mounting in Mounting::all() {
            assert_eq!(mounting.to_string().parse(), Ok(mounting));
        }
        assert_eq!(Mounting::default().to_string(), "forward-right-down");
        for (text, error) in [
            ("forward", MountingError::Words),
            ("forward-right-sideways", MountingError::Words),
            ("forward-right-down-down", MountingError::Words),
            ("forward-backward-down", MountingError::Parallel),
            (
                "forward-right-up",
                MountingError::LeftHanded(Mounting::default()),
            ),
            (
                "Forward-RIGHT-down",
                MountingError::Capitals(Mounting::default()),
            ),
        ] {
            assert_eq!(text.parse::<Mounting>(), Err(error), "{text}");
        }
    }

    /// A sensor that lies on its left side at 1 g has its z axis to the left:
    /// it measures -g along its y axis, which points down.
    #[test]
    fn a_sensor_on_its_side_measures_the_bodys_forces() {
        let side: Mounting = "forward-down-left".parse().unwrap();
        let level_flight = side.rotation().turned([0.3, -9.81, 0.5]);
        assert_eq!(level_flight, [0.3, -0.5, -9.81]);
    }

    /// Rotations by a quarter of a turn are mountings.
    #[test]
    fn a_free_rotation_agrees_with_the_right_angled_ones() {
        let quarter = core::f64::consts::FRAC_PI_2;
        for (angles, name) in [
            ([quarter, 0.0, 0.0], "forward-down-left"),
            ([0.0, quarter, 0.0], "up-right-forward"),
            ([0.0, 0.0, quarter], "right-backward-down"),
            ([2.0 * quarter, 0.0, quarter], "right-forward-up"),
        ] {
            let [roll_rad, pitch_rad, heading_rad] = angles;
            let free = Rotation::of_angles(EulerAngles {
                roll_rad,
                pitch_rad,
                heading_rad,
            });
            let named = name.parse::<Mounting>().unwrap().rotation();
            for (free, named) in free.0.as_flattened().iter().zip(named.0.as_flattened()) {
                assert!((free - named).abs() < 1e-15, "{name}");
            }
        }
    }
}
