//! The inverse of a surface's play.

/// Reversals smaller than this get a part of the play only, so that noise does
/// not throw the surface from one side to the other; in the surface's units.
const REVERSAL: f64 = 0.04;

/// Adds the width of a surface's play to a command that reverses: the surface
/// then follows the command as if there were no play (Tao and Kokotović 1996,
/// chapter 3). Play in a loop with integrals makes it oscillate at any gain; by
/// its describing function less gain makes it slower and larger.
///
/// ```
/// use fcc_fixed_wing::control::PlayInverse;
///
/// let mut inverse = PlayInverse::new(0.0);
/// let up = inverse.step(0.3, 0.1);
/// let down = inverse.step(0.2, 0.1);
/// // The command went back by 0.1, and by the play of 0.1.
/// assert!((up - down - 0.2).abs() < 1e-12);
/// // Without play a command stays as it is.
/// assert_eq!(PlayInverse::new(0.0).step(0.3, 0.0), 0.3);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct PlayInverse {
    centre: f64,
}

impl PlayInverse {
    /// From a present command.
    pub const fn new(command: f64) -> Self {
        Self { centre: command }
    }

    /// The command for a surface with this width of play; both -1..=1.
    pub fn step(&mut self, command: f64, play: f64) -> f64 {
        let half = 0.5 * REVERSAL;
        self.centre = self.centre.max(command - half).min(command + half);
        (command + play * (command - self.centre) / REVERSAL).clamp(-1.0, 1.0)
    }
}
