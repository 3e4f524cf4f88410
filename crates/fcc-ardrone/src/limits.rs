//! What a full stick means: the part of the configuration that clients set.

use core::ops::RangeInclusive;

/// Limits of flight. Indoors and outdoors each have their own.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Limits {
    /// Tilt at a full stick, rad.
    pub tilt_rad: f64,
    /// Climb rate at a full stick, m/s.
    pub climb_mps: f64,
    /// Turn rate at a full stick, rad/s.
    pub yaw_radps: f64,
    /// Height above the take-off, m.
    pub height_m: f64,
}

impl Limits {
    /// The firmware's own, of 2.4.8.
    const INDOOR: Self = Self {
        tilt_rad: 0.209_439_51,
        climb_mps: 0.7,
        yaw_radps: 1.745_329_25,
        height_m: 3.0,
    };
    const OUTDOOR: Self = Self {
        tilt_rad: 0.349_065_85,
        climb_mps: 1.0,
        yaw_radps: 3.490_658_5,
        height_m: 100.0,
    };
}

/// The limits of both places, and which place it is.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct Configured {
    indoor: Limits,
    outdoor: Limits,
    is_outdoor: bool,
}

impl Default for Configured {
    fn default() -> Self {
        Self {
            indoor: Limits::INDOOR,
            outdoor: Limits::OUTDOOR,
            is_outdoor: false,
        }
    }
}

impl Configured {
    pub(crate) const fn limits(&self) -> Limits {
        if self.is_outdoor {
            self.outdoor
        } else {
            self.indoor
        }
    }

    /// Sets a value, if its key is one of these and it is within its range (developer guide,
    /// section 8.6); values of other keys have no effect here.
    pub(crate) fn set(&mut self, key: &str, value: &str) {
        let Some(name) = key.strip_prefix("control:") else {
            return;
        };
        if name == "outdoor" {
            self.is_outdoor = value == "TRUE";
            return;
        }
        let (place, name) = if let Some(name) = name.strip_prefix("indoor_") {
            (&mut self.indoor, name)
        } else if let Some(name) = name.strip_prefix("outdoor_") {
            (&mut self.outdoor, name)
        } else if self.is_outdoor {
            (&mut self.outdoor, name)
        } else {
            (&mut self.indoor, name)
        };
        let within = |range: RangeInclusive<f64>| {
            let value = value.parse().ok()?;
            range.contains(&value).then_some(value)
        };
        match name {
            "euler_angle_max" => replace(&mut place.tilt_rad, within(0.0..=0.52)),
            "control_vz_max" => replace(&mut place.climb_mps, within(200.0..=2000.0).map(to_m)),
            "control_yaw" => replace(&mut place.yaw_radps, within(0.7..=6.11)),
            "altitude_max" => replace(&mut place.height_m, within(500.0..=100_000.0).map(to_m)),
            _ => {}
        }
    }
}

fn to_m(mm: f64) -> f64 {
    1e-3 * mm
}

fn replace(limit: &mut f64, value: Option<f64>) {
    if let Some(value) = value {
        *limit = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_of_the_place_and_within_their_range() {
        let mut configured = Configured::default();
        configured.set("control:euler_angle_max", "0.25");
        configured.set("control:outdoor_control_vz_max", "1500");
        configured.set("control:altitude_max", "499");
        configured.set("control:control_yaw", "inf");
        configured.set("general:navdata_demo", "TRUE");
        let indoor = configured.limits();
        assert_eq!(
            (indoor.tilt_rad, indoor.climb_mps, indoor.height_m),
            (0.25, 0.7, 3.0)
        );
        assert!((indoor.yaw_radps.to_degrees() - 100.0).abs() < 1e-6);
        configured.set("control:outdoor", "TRUE");
        let outdoor = configured.limits();
        assert!((outdoor.tilt_rad.to_degrees() - 20.0).abs() < 1e-6);
        assert_eq!(outdoor.climb_mps, 1.5);
    }
}
