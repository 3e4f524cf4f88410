//! What the interrupted flight flew.

use fcc_core::flight::{AltitudeReference, Surfaces};
use fcc_fixed_wing::Resume;
use fcc_guidance::route::TookOff;
use fcc_guidance::{Mode, Progress, Targets};

pub(super) const FLOWN: Resume = Resume {
    progress: Progress {
        mode: Mode::Hold,
        item: 0,
        elapsed_s: 20.0,
        captured: Targets {
            airspeed_mps: 50.0,
            heading_rad: 1.0,
            altitude_m: 900.0,
        },
    },
    surfaces: Surfaces {
        throttle: 0.6,
        elevator: 0.0,
        aileron: 0.0,
        rudder: 0.0,
        ..Surfaces::IDLE
    },
    altimeter_setting_pa: Some(102_000.0),
    altitude_reference: AltitudeReference::SeaLevel,
    took_off: TookOff {
        latitude_rad: 0.82,
        longitude_rad: 0.14,
        course_rad: 0.5,
        elevation_m: 431.5,
    },
};
