//! What is measured of a room, wanted of it and done about it.

use fcc_core::framework::Reading;
use fcc_core::schema;

schema! {
    /// Measurements of a room.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Measured {
        /// Temperature of its air.
        #[field(1)]
        pub(crate) room_c: Reading<f64>,
    }
}

schema! {
    /// Set points of a room.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Wanted {
        /// Temperature of its air.
        #[field(1)]
        pub(crate) room_c: f64,
    }
}

schema! {
    /// Outputs.
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub(crate) struct Heating {
        /// Power of the heater: 0 off, 1 full.
        #[field(1, range = 0.0..=1.0)]
        pub(crate) power: f64,
    }
}

fcc_core::readings!(Measured {
    room_c: "the room's temperature"
});
