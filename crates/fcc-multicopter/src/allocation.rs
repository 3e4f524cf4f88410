//! Allocation: from axes to rotors, within what the rotors can do.

use fcc_core::flight::MOST_ROTORS;
use fcc_core::units::GRAVITY_MPS2;
use nalgebra::{SMatrix, SVector, Vector4};

use crate::airframe::{Airframe, Effectiveness, Refusal};

/// Specific thrust, m/s², and angular accelerations about x, y, z, rad/s².
pub type Demand = Vector4<f64>;
type Shares = SVector<f64, MOST_ROTORS>;

/// A rotor that turns gives at least this share of its thrust.
const LEAST_SHARE: f64 = 0.02;
/// Yaw may take this much beyond the limit; then thrust is lowered.
const YAW_RESERVE: f64 = 0.15;
/// The determinant of the normalised axes below which one is not controlled without another: 1
/// for axes that are independent.
const LEAST_DETERMINANT: f64 = 0.01;

/// The shares of thrust of the rotors, and what of the demand they do not give.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Allocated {
    /// 0..=1 for each rotor.
    pub shares: [f64; MOST_ROTORS],
    /// Demanded, and not allocated.
    pub missing: Demand,
}

/// Distributes a demand to the rotors by the pseudo-inverse of their effectiveness. What exceeds
/// them is given up in the order yaw, pitch, roll, but before roll and pitch thrust falls.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Allocator {
    effectiveness: Effectiveness,
    inverse: SMatrix<f64, MOST_ROTORS, 4>,
    is_rotor: [bool; MOST_ROTORS],
    /// A rotor is lost: what the others do about yaw is as far as possible undone.
    yaws: bool,
}

impl Allocator {
    /// For an airframe.
    ///
    /// # Errors
    /// When its rotors do not control the four axes independently, or cannot lift it.
    pub fn new(airframe: &Airframe) -> Result<Self, Refusal> {
        let effectiveness = airframe.effectiveness();
        let mut normalised = effectiveness;
        for mut row in normalised.row_iter_mut() {
            let length = row.norm();
            row /= length;
        }
        let determinant = (normalised * normalised.transpose()).determinant();
        let gram = effectiveness * effectiveness.transpose();
        let inverse = gram
            .try_inverse()
            .filter(|_| determinant > LEAST_DETERMINANT);
        let inverse = effectiveness.transpose() * inverse.ok_or(Refusal::NotControllable)?;
        let hover = airframe.hover_share();
        if !(0.1..=0.7).contains(&hover) {
            return Err(Refusal::Hover(hover));
        }
        Ok(Self {
            effectiveness,
            inverse,
            is_rotor: airframe.rotors.map(|rotor| rotor.is_some()),
            yaws: false,
        })
    }

    pub(crate) const fn effectiveness(&self) -> &Effectiveness {
        &self.effectiveness
    }

    /// The same without a rotor; none if the others cannot lift it level: of four rotors the
    /// one opposite would have to stand still. Thrust, roll and pitch come first, yaw takes what
    /// is left.
    pub(crate) fn without(&self, rotor: usize) -> Option<Self> {
        let mut rest = *self;
        *rest.is_rotor.get_mut(rotor)? = false;
        rest.effectiveness.column_mut(rotor).fill(0.0);
        rest.yaws = true;
        let level = rest.effectiveness.fixed_rows::<3>(0).into_owned();
        let inverse = level.transpose() * (level * level.transpose()).try_inverse()?;
        rest.inverse.fixed_columns_mut::<3>(0).copy_from(&inverse);
        let about_yaw = rest.effectiveness.row(3).transpose();
        let free = about_yaw - inverse * (level * about_yaw);
        let turns = about_yaw.dot(&free);
        let yaw = if turns > LEAST_DETERMINANT {
            free / turns
        } else {
            Shares::zeros()
        };
        rest.inverse.column_mut(3).copy_from(&yaw);
        let hovers = inverse.column(0) * GRAVITY_MPS2;
        let mut lift = hovers
            .iter()
            .zip(rest.is_rotor)
            .filter(|(_, is_rotor)| *is_rotor);
        lift.all(|(share, _)| (2.0 * LEAST_SHARE..=0.9).contains(share))
            .then_some(rest)
    }

    /// The shares for a demand.
    pub fn allocate(&self, demand: &Demand) -> Allocated {
        let [thrust, roll, pitch, yaw] = demand.data.0[0];
        let mut shares = self.inverse.column(0) * thrust
            + self.inverse.column(1) * roll
            + self.inverse.column(2) * pitch;
        self.give_up(&mut shares, 0, thrust, 1.0);
        self.give_up(&mut shares, 1, roll, 1.0);
        self.give_up(&mut shares, 2, pitch, 1.0);
        let undone = if self.yaws {
            self.effectiveness.row(3).tr_dot(&shares)
        } else {
            0.0
        };
        shares += self.inverse.column(3) * (yaw - undone);
        self.give_up(&mut shares, 3, yaw - undone, 1.0 + YAW_RESERVE);
        self.give_up(&mut shares, 0, thrust, 1.0);
        for (share, is_rotor) in shares.iter_mut().zip(self.is_rotor) {
            *share = if is_rotor {
                share.clamp(LEAST_SHARE, 1.0)
            } else {
                0.0
            };
        }
        Allocated {
            shares: shares.data.0[0],
            missing: demand - self.effectiveness * shares,
        }
    }

    /// Gives up as little as possible of a demand on one axis, so that all shares are within
    /// the limits, or else beyond both by the same.
    fn give_up(&self, shares: &mut Shares, axis: usize, demanded: f64, highest: f64) {
        let direction = self.inverse.column(axis);
        let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
        let rotors = shares.iter().zip(direction.iter()).zip(self.is_rotor);
        for ((share, per_axis), is_rotor) in rotors {
            if !is_rotor || per_axis.abs() < 1e-12 {
                continue;
            }
            let (a, b) = (
                (LEAST_SHARE - share) / per_axis,
                (highest - share) / per_axis,
            );
            least = least.max(a.min(b));
            most = most.min(a.max(b));
        }
        let change = if least > most {
            0.5 * (least + most)
        } else {
            0.0_f64.clamp(least, most)
        };
        let change = change.clamp((-demanded).min(0.0), (-demanded).max(0.0));
        *shares += direction * change;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::airframe::Rotor;

    fn allocator(count: usize) -> Allocator {
        // All of the same weight and lift.
        let airframe = Airframe {
            rotor_thrust_n: 34.0 / count as f64,
            ..Airframe::default()
        };
        Allocator::new(&airframe.with_ring(count, 0.233)).unwrap()
    }

    /// What it reports as missing is what the rotors do not give, by their forces.
    fn given(airframe: &Airframe, shares: &[f64; MOST_ROTORS]) -> Demand {
        let (mut force, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for (rotor, share) in airframe.rotors.iter().flatten().zip(shares) {
            let thrust = rotor.axis * (airframe.rotor_thrust_n * share);
            force += thrust;
            torque += rotor.place_m.cross(&thrust)
                - Vector3::z()
                    * (rotor.spin * airframe.torque_ratio_m * airframe.rotor_thrust_n * share);
        }
        let turn = torque.component_div(&airframe.inertia_kgm2);
        Demand::new(-force.z / airframe.mass_kg, turn.x, turn.y, turn.z)
    }

    /// By hand, of six: 5a - b = T, 2b = a with b along the lost rotor's direction: the opposite
    /// one lifts T/9, its neighbours T/6, those of the lost one 5T/18.
    #[test]
    fn six_rotors_less_one_lift_it_level() {
        let all = allocator(6);
        let rest = all.without(0).unwrap();
        let level = rest.inverse.column(0) * GRAVITY_MPS2;
        let total: f64 = level.iter().sum();
        let shares = [0.0, 5.0 / 18.0, 1.0 / 6.0, 1.0 / 9.0, 1.0 / 6.0, 5.0 / 18.0];
        for (share, expected) in level.iter().zip(shares) {
            assert!((share / total - expected).abs() < 1e-9, "{level}");
        }
        let hover = Demand::new(GRAVITY_MPS2, 0.0, 0.0, 0.0);
        let missing = rest.allocate(&hover).missing;
        assert!(missing.xyz().norm() < 1e-9, "{missing}");
        assert!(allocator(8).without(5).is_some());
        assert!(allocator(4).without(1).is_none());
    }

    #[test]
    fn what_fits_is_allocated_to_any_number_of_rotors() {
        for count in [4, 6, 8] {
            let demand = Demand::new(GRAVITY_MPS2, 8.0, -5.0, 1.0);
            let allocated = allocator(count).allocate(&demand);
            assert!(
                allocated.missing.norm() < 1e-9,
                "{count}: {}",
                allocated.missing
            );
            let used = allocated
                .shares
                .iter()
                .filter(|share| **share > 0.0)
                .count();
            assert_eq!(used, count);
        }
    }

    /// Roll and pitch that fit are kept in full, yaw is given up first.
    #[test]
    fn yaw_is_given_up_before_pitch_and_roll() {
        let airframe = Airframe::default();
        for count in [4, 6, 8] {
            let airframe = Airframe {
                rotor_thrust_n: 34.0 / count as f64,
                ..airframe
            }
            .with_ring(count, 0.233);
            let demand = Demand::new(GRAVITY_MPS2, 25.0, 12.0, 60.0);
            let allocated = Allocator::new(&airframe).unwrap().allocate(&demand);
            let [thrust, roll, pitch, yaw] = allocated.missing.data.0[0];
            assert!(
                roll.abs() < 1e-6 && pitch.abs() < 1e-6,
                "{}",
                allocated.missing
            );
            assert!(yaw > 10.0 && yaw <= 60.0, "{yaw}");
            assert!(thrust >= -1e-9, "thrust rose by {thrust}");
            let error = given(&airframe, &allocated.shares) + allocated.missing - demand;
            assert!(error.norm() < 1e-9, "{error}");
        }
    }

    /// At full thrust it descends rather than not to roll.
    #[test]
    fn thrust_falls_before_roll_is_given_up() {
        let demand = Demand::new(24.0, 60.0, 0.0, 0.0);
        let allocated = allocator(4).allocate(&demand);
        assert!(allocated.missing[1].abs() < 1e-6, "{}", allocated.missing);
        assert!(allocated.missing[0] > 1.0, "{}", allocated.missing);
    }

    /// Without airmode, little thrust gives up roll, and does not rise. Nothing is reversed.
    #[test]
    fn thrust_does_not_rise_for_roll() {
        let allocated = allocator(4).allocate(&Demand::new(1.5, 100.0, -30.0, 20.0));
        assert!(allocated.missing[0] > -1e-6, "{}", allocated.missing);
        for (missing, demanded) in [(allocated.missing[1], 100.0), (allocated.missing[2], -30.0)] {
            assert!(
                (0.0..=1.0).contains(&(missing / demanded)),
                "{missing} of {demanded}"
            );
        }
    }

    /// PX4 issue 28589: a nearly singular inverse gave gains of 2,000.
    #[test]
    fn rotors_that_do_not_yaw_are_refused() {
        let airframe = Airframe::default();
        let mut rotors = airframe.rotors;
        for rotor in rotors.iter_mut().flatten() {
            *rotor = Rotor {
                spin: 1.0,
                ..*rotor
            };
        }
        let refused = Allocator::new(&Airframe { rotors, ..airframe });
        assert_eq!(refused, Err(Refusal::NotControllable));
        let heavy = Airframe {
            mass_kg: 4.2,
            ..airframe
        };
        let text = std::string::ToString::to_string(&Allocator::new(&heavy).unwrap_err());
        assert!(
            text.starts_with("hovering takes 87 % of the thrust"),
            "{text}"
        );
    }
}
