//! The dataref of the engage switch: the default, and what is known of generic
//! lights.
//!
//! `sim/cockpit2/switches/generic_lights_switch` has 64 elements since X-Plane
//! 9.40 (Supnik, "Parameterized Lights, Generic Lights, and Plugin-Controlled
//! Lights", developer.x-plane.com, 2009) and 128 since 11.10. Public aircraft
//! use many of the first fifty as logo, wing, dome and flood lights, and 62, 63
//! and 84. X-Plane 11 has a command for each of the first 64:
//! `sim/lights/generic_01_light_tog` switches element 0, and so on (its
//! `Commands.txt`), so a joystick button can be bound to one.

/// No public aircraft was found that uses this element, and every version since
/// 9.40 has it. Its command is `sim/lights/generic_57_light_tog`.
pub(crate) const DEFAULT: &str = "sim/cockpit2/switches/generic_lights_switch[56]";

const GENERIC_LIGHTS: &str = "sim/cockpit2/switches/generic_lights_switch";
/// Number of elements before and since [`MORE_SINCE`].
const BEFORE: u32 = 64;
pub(crate) const MOST: u32 = 128;
/// 11.10, as `xplane_internal_version` has it.
const MORE_SINCE: u32 = 111_000;

/// A version that answers requests for datarefs that it does not have is known
/// by its answer to this one. It is asked only for another switch than a generic
/// light: which of those exist is known.
pub(crate) const NONEXISTENT_DATAREF: &str = "fccd/does_not_exist";
/// No subscription has this index.
pub(crate) const NONEXISTENT_INDEX: i32 = 9_005;

/// The element, if the path is one of a generic light.
pub(crate) fn generic_light(path: &str) -> Option<u32> {
    let element = path.strip_prefix(GENERIC_LIGHTS)?;
    if element.is_empty() {
        return Some(0);
    }
    let number = element.strip_prefix('[')?.strip_suffix(']')?;
    // Of a number beyond u32 it is sufficient to know that it is too large.
    number
        .bytes()
        .all(|byte| byte.is_ascii_digit())
        .then(|| number.parse().unwrap_or(u32::MAX))
}

/// The number of generic lights in a version, if the path is one of a light
/// that this version does not have. X-Plane may answer for it nevertheless.
pub(crate) fn lights_if_beyond(path: &str, version: u32) -> Option<u32> {
    let lights = if version < MORE_SINCE { BEFORE } else { MOST };
    (generic_light(path)? >= lights).then_some(lights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_generic_light_is_known_by_its_path() {
        assert_eq!(generic_light(DEFAULT), Some(56));
        assert_eq!(generic_light(GENERIC_LIGHTS), Some(0));
        let huge = format!("{GENERIC_LIGHTS}[99999999999]");
        assert_eq!(generic_light(&huge), Some(u32::MAX));
        for other in [
            "sim/time/paused",
            "sim/cockpit2/switches/generic_lights_switch[x]",
        ] {
            assert_eq!(generic_light(other), None, "{other}");
        }
    }

    #[test]
    fn the_default_exists_since_x_plane_10_and_a_higher_one_since_11_10() {
        let high = format!("{GENERIC_LIGHTS}[64]");
        assert_eq!(lights_if_beyond(DEFAULT, 101_000), None);
        assert_eq!(lights_if_beyond(&high, 105_101), Some(64));
        assert_eq!(lights_if_beyond(&high, 111_000), None);
        let highest = format!("{GENERIC_LIGHTS}[128]");
        assert_eq!(lights_if_beyond(&highest, 121_000), Some(128));
        assert_eq!(lights_if_beyond("sim/time/paused", 0), None);
    }
}
