//! The latest value of each quantity, and which measurements they complete.

use core::time::Duration;

use fcc_core::framework::Time;

use crate::quantity::Quantity;

/// A measurement made of one or more quantities.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub(crate) enum Group {
    Attitude,
    TrueAttitude,
    Heading,
    Rates,
    Acceleration,
    Loads,
    Velocity,
    Airspeed,
    Altitude,
    AngleOfAttack,
    Surfaces,
    Switch,
}

impl Group {
    const COUNT: usize = 12;
}

/// A value that stands alone is used up to this age: some frames at the lowest
/// rate, and a lost datagram.
const RECENT: Duration = Duration::from_millis(500);

#[derive(Clone, Copy, Debug, Default)]
struct Value {
    value: f64,
    arrived: Time,
}

/// The latest value of each quantity.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    values: [Value; Quantity::COUNT],
    /// For each group, a bit for each quantity that arrived since the group was
    /// last complete.
    new: [u64; Group::COUNT],
}

const fn bit(quantity: Quantity) -> u64 {
    1 << (quantity as u8)
}

impl Default for Values {
    fn default() -> Self {
        Self {
            values: [Value::default(); Quantity::COUNT],
            new: [0; Group::COUNT],
        }
    }
}

impl Values {
    pub(crate) fn set(&mut self, quantity: Quantity, value: f64, arrived: Time) {
        if let Some(place) = self.values.get_mut(quantity as usize) {
            *place = Value { value, arrived };
        }
        for new in &mut self.new {
            *new |= bit(quantity);
        }
    }

    /// When a quantity last arrived.
    pub(crate) fn arrived(&self, quantity: Quantity) -> Time {
        self.value(quantity).arrived
    }

    /// The latest value of a quantity, if it is not older than [`RECENT`].
    pub(crate) fn recent(&self, quantity: Quantity, now: Time) -> Option<f64> {
        let Value { value, arrived } = self.value(quantity);
        (!arrived.is_never() && now.since(arrived) <= RECENT).then_some(value)
    }

    fn value(&self, quantity: Quantity) -> Value {
        self.values
            .get(quantity as usize)
            .copied()
            .unwrap_or_default()
    }

    /// The values of a group's members and the time of the oldest, if each
    /// arrived since the last call that returned values.
    pub(crate) fn whole<const N: usize>(
        &mut self,
        group: Group,
        members: [Quantity; N],
    ) -> Option<([f64; N], Time)> {
        let all = members.iter().fold(0, |all, member| all | bit(*member));
        let new = self.new.get_mut(group as usize)?;
        if *new & all != all {
            return None;
        }
        *new = 0;
        let values = members.map(|member| self.value(member));
        let oldest = values.iter().map(|value| value.arrived).min()?;
        Some((values.map(|value| value.value), oldest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_is_complete_when_every_member_is_new_and_as_old_as_the_oldest() {
        let (early, late) = (Time::from_nanos(1), Time::from_nanos(2));
        let members = [Quantity::Pitch, Quantity::Roll];
        let mut values = Values::default();
        values.set(Quantity::Pitch, 0.1, early);
        assert_eq!(values.whole(Group::Attitude, members), None);
        values.set(Quantity::Roll, 0.2, late);
        assert_eq!(
            values.whole(Group::Attitude, members),
            Some(([0.1, 0.2], early))
        );
        assert_eq!(
            values.whole(Group::Attitude, members),
            None,
            "returned once"
        );
        values.set(Quantity::Roll, 0.3, late);
        assert_eq!(values.whole(Group::Attitude, members), None, "pitch is old");
    }

    #[test]
    fn groups_that_share_a_member_do_not_take_it_from_each_other() {
        let now = Time::from_nanos(1);
        let mut values = Values::default();
        values.set(Quantity::Pitch, 0.1, now);
        assert!(values.whole(Group::Attitude, [Quantity::Pitch]).is_some());
        assert!(
            values
                .whole(Group::Acceleration, [Quantity::Pitch])
                .is_some()
        );
    }
}
