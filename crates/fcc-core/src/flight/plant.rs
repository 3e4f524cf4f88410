//! A simulated plant's clock and state, and what else acts on the controls.

use crate::schema;

schema! {
    /// A simulated plant's clock and state.
    ///
    /// ```
    /// use fcc_core::flight::{Plant, PlantState};
    ///
    /// let plant = Plant { time_s: 12.5, state: PlantState::Paused };
    /// assert_ne!(plant.state, PlantState::Running);
    /// ```
    #[derive(Clone, Copy, PartialEq, Debug, Default)]
    pub struct Plant {
        /// The plant's time in s. The loop integrates with it if there is one:
        /// a simulator whose frame rate falls slows its time.
        #[field(1)]
        pub time_s: f64,
        /// The plant's state.
        #[field(2)]
        pub state: PlantState,
    }
}

schema! {
    /// What acts on the controls besides this program, as far as a source can
    /// tell.
    ///
    /// ```
    /// use fcc_core::flight::OtherControl;
    ///
    /// let climbing_alone = OtherControl { autopilot: true };
    /// assert_ne!(climbing_alone, OtherControl::default());
    /// ```
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
    pub struct OtherControl {
        /// Another autopilot moves the controls by its servos.
        #[field(1)]
        pub autopilot: bool,
    }
}

schema! {
    /// The state of a simulated plant.
    ///
    /// ```
    /// use fcc_core::flight::PlantState;
    ///
    /// assert_eq!(PlantState::from_number(1), Some(PlantState::Paused));
    /// ```
    pub enum PlantState {
        /// Time runs.
        Running = 0,
        /// Halted by its user: outputs are held, nothing integrates.
        Paused = 1,
        /// It sends, but its clock has stopped although it is not paused.
        Stalled = 2,
        /// Time runs, slower than the wall clock or at a low frame rate.
        Slow = 3,
        /// Its clock jumped: it was restarted, reloaded or repositioned.
        Jumped = 4,
        /// It shows a recorded flight: what it measures is not its present
        /// state, and nothing is sent to it.
        Replaying = 5,
        /// It took back the controls by itself, as when its aircraft is loaded
        /// again.
        Reloaded = 6,
        /// Time runs more than twice as fast as the wall clock.
        Fast = 7,
    }
}
