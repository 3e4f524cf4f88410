//! What the laws have in common.

use core::f64::consts::PI;

use super::{L1, L1Config, Motion, Npfg, NpfgConfig, Path};

/// A law of guidance: the acceleration to the right of the air velocity, m/s², that
/// brings an aircraft onto a path and along it.
pub trait LateralLaw {
    /// The acceleration for a tick. It is finite for any finite motion.
    fn acceleration_mps2(&mut self, path: &Path, motion: &Motion) -> f64;
}

/// The law that is chosen by configuration.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Law {
    /// Park, Deyst and How 2004.
    L1(L1),
    /// Stastny 2018.
    Npfg(Npfg),
}

impl Law {
    /// L1 with a configuration.
    pub fn l1(config: L1Config) -> Self {
        Self::L1(L1::new(config))
    }

    /// NPFG with a configuration.
    pub fn npfg(config: NpfgConfig) -> Self {
        Self::Npfg(Npfg::new(config))
    }
}

impl LateralLaw for Law {
    fn acceleration_mps2(&mut self, path: &Path, motion: &Motion) -> f64 {
        match self {
            Self::L1(law) => law.acceleration_mps2(path, motion),
            Self::Npfg(law) => law.acceleration_mps2(path, motion),
        }
    }
}

/// Beyond this error of the course a turn that has begun keeps its direction: which
/// way is the shorter one may change with each gust.
const REVERSED_RAD: f64 = 0.9 * PI;

/// Keeps the direction of a turn.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub(super) struct TurnDirection {
    last_rad: f64,
}

impl TurnDirection {
    /// The error of the course in -π to π, or beyond by what the turn that has
    /// begun leaves.
    pub(super) fn keep(&mut self, error_rad: f64) -> f64 {
        let flips = error_rad.abs() > REVERSED_RAD
            && self.last_rad.abs() > REVERSED_RAD
            && (error_rad > 0.0) != (self.last_rad > 0.0);
        let kept = if flips { -error_rad } else { error_rad };
        self.last_rad = kept;
        kept
    }
}
