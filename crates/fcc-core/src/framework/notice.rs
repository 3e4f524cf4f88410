//! What a controller notices.

use crate::schema;

schema! {
    /// Something that a controller noticed, with its duration: for an event.
    ///
    /// ```
    /// use fcc_core::framework::Notice;
    ///
    /// // A thermostat's own number for a window that was open for a minute.
    /// let window = Notice { kind: 1, lasted_ns: 60_000_000_000, ..Notice::default() };
    /// assert_eq!(window.lasted_s(), 60.0);
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct Notice {
        /// Which, by a number of the controller's own:
        /// [`Controller::write_notice`](super::Controller::write_notice) names
        /// it.
        #[field(1)]
        pub kind: u8,
        /// How long it lasted, ns.
        #[field(2)]
        pub lasted_ns: u64,
        /// How large it was, in thousandths of what the kind is measured in; 0 if
        /// it has no size.
        #[field(3)]
        pub amount_permille: u16,
        /// Which one of several, from 1; 0 if there are not several.
        #[field(4)]
        pub item: u16,
    }
}

/// The thousandths of a notice's amount.
pub const PERMILLE: u16 = 1_000;

impl Notice {
    /// How long it lasted, s.
    pub fn lasted_s(&self) -> f64 {
        self.lasted_ns as f64 / 1e9
    }
}
