//! The latest value of each quantity, and which measurements they complete.
//!
//! X-Plane sends a frame's values in one datagram, each at most at the rate at
//! which it was requested. Above this rate some frames lack some values, for
//! subscriptions begun in different frames different ones. So a measurement of
//! several quantities is taken from the last frame that had all of them, and
//! made of several frames only while none has.

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
    /// X-Plane's own.
    PressureAltitude,
    /// What the pilot's altimeter indicates, and its setting.
    Altimeter,
    AngleOfAttack,
    Surfaces,
    Switch,
    PilotControls,
    DifferentialPressure,
    Wheels,
    Height,
    EngineSpeed,
    BatteryVoltage,
}

impl Group {
    const COUNT: usize = 19;

    /// All of them, in the order of their numbers.
    const ALL: [Self; Self::COUNT] = [
        Self::Attitude,
        Self::TrueAttitude,
        Self::Heading,
        Self::Rates,
        Self::Acceleration,
        Self::Loads,
        Self::Velocity,
        Self::Airspeed,
        Self::PressureAltitude,
        Self::Altimeter,
        Self::AngleOfAttack,
        Self::Surfaces,
        Self::Switch,
        Self::PilotControls,
        Self::DifferentialPressure,
        Self::Wheels,
        Self::Height,
        Self::EngineSpeed,
        Self::BatteryVoltage,
    ];

    /// The quantities of which it is made, in the order of its values.
    const fn members(self) -> &'static [Quantity] {
        use Quantity as Q;
        match self {
            Self::Attitude => &[Q::Pitch, Q::Roll],
            Self::TrueAttitude => &[Q::TruePitch, Q::TrueRoll, Q::Pitch, Q::Roll],
            Self::Heading => &[Q::MagneticHeading],
            Self::Rates => &[Q::RollRate, Q::PitchRate, Q::YawRate],
            Self::Acceleration => &[
                Q::AccelerationEast,
                Q::AccelerationUp,
                Q::AccelerationSouth,
                Q::LocalHeading,
                Q::Pitch,
                Q::Roll,
            ],
            Self::Loads => &[Q::LoadNormal, Q::LoadAxial, Q::LoadSide],
            Self::Velocity => &[Q::VelocityEast, Q::VelocityUp, Q::VelocitySouth],
            Self::Airspeed => &[Q::Airspeed],
            Self::PressureAltitude => &[Q::PressureAltitude],
            Self::Altimeter => &[Q::Altitude, Q::AltimeterSetting],
            Self::AngleOfAttack => &[Q::AngleOfAttack],
            Self::Surfaces => &[Q::Throttle, Q::YokePitch, Q::YokeRoll, Q::YokeHeading],
            Self::Switch => &[Q::EngageSwitch],
            Self::PilotControls => &[Q::PilotPitch, Q::PilotRoll, Q::PilotYaw],
            Self::DifferentialPressure => &[Q::DifferentialPressure],
            Self::Wheels => &[Q::OnGround],
            Self::Height => &[Q::Height],
            Self::EngineSpeed => &[Q::EngineSpeed],
            Self::BatteryVoltage => &[Q::BatteryVoltage],
        }
    }
}

/// A value that stands alone is used up to this age: some frames at the lowest
/// rate, and a lost datagram.
const RECENT: Duration = Duration::from_millis(500);

#[derive(Clone, Copy, Debug, Default)]
struct Value {
    value: f64,
    arrived: Time,
    /// The frame in which it arrived.
    frame: u32,
}

/// The most quantities of which a measurement is made.
const MOST_MEMBERS: usize = 6;

/// The last values of a group that arrived in one frame.
#[derive(Clone, Copy, Debug, Default)]
struct Together {
    values: [f64; MOST_MEMBERS],
    arrived: Time,
    /// Not returned yet.
    is_new: bool,
}

/// If a group has not arrived in one frame for this long, its members may come
/// from several: two frames at the lowest rate that is not slow.
const TOGETHER_WITHIN: Duration = Duration::from_millis(100);

/// The latest value of each quantity.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    values: [Value; Quantity::COUNT],
    /// Counts the frames; the present one.
    frame: u32,
    /// For each group, a bit for each quantity that arrived since the group was
    /// last returned.
    new: [u64; Group::COUNT],
    together: [Together; Group::COUNT],
}

const fn bit(quantity: Quantity) -> u64 {
    1 << (quantity as u8)
}

impl Default for Values {
    fn default() -> Self {
        Self {
            values: [Value::default(); Quantity::COUNT],
            frame: 0,
            new: [0; Group::COUNT],
            together: [Together::default(); Group::COUNT],
        }
    }
}

impl Values {
    /// Begins a frame: a datagram of values.
    pub(crate) fn begin_frame(&mut self) {
        self.frame = self.frame.wrapping_add(1);
    }

    pub(crate) fn set(&mut self, quantity: Quantity, value: f64, arrived: Time) {
        let frame = self.frame;
        if let Some(place) = self.values.get_mut(quantity as usize) {
            *place = Value {
                value,
                arrived,
                frame,
            };
        }
        for new in &mut self.new {
            *new |= bit(quantity);
        }
    }

    /// Ends a frame: keeps the values of the groups that arrived in it whole.
    pub(crate) fn end_frame(&mut self) {
        let (values, frame) = (&self.values, self.frame);
        for (group, kept) in Group::ALL.into_iter().zip(&mut self.together) {
            let mut found = *kept;
            let is_whole = group
                .members()
                .iter()
                .zip(&mut found.values)
                .all(|(member, into)| {
                    let value = values.get(*member as usize).copied().unwrap_or_default();
                    *into = value.value;
                    found.arrived = value.arrived;
                    value.frame == frame
                });
            if is_whole {
                found.is_new = true;
                *kept = found;
            }
        }
    }

    /// When a quantity last arrived.
    pub(crate) fn arrived(&self, quantity: Quantity) -> Time {
        self.value(quantity).arrived
    }

    /// The latest value of a quantity, if it is not older than [`RECENT`].
    pub(crate) fn recent(&self, quantity: Quantity, now: Time) -> Option<f64> {
        let Value { value, arrived, .. } = self.value(quantity);
        (!arrived.is_never() && now.since(arrived) <= RECENT).then_some(value)
    }

    fn value(&self, quantity: Quantity) -> Value {
        self.values
            .get(quantity as usize)
            .copied()
            .unwrap_or_default()
    }

    /// The values of a group's members and their time, once for each time they
    /// arrived: those of the last frame that had them all. While no frame has
    /// them all, the latest of each and the time of the oldest, if each arrived
    /// since the last call that returned values.
    pub(crate) fn whole<const N: usize>(&mut self, group: Group) -> Option<([f64; N], Time)> {
        let members = group.members().first_chunk::<N>()?;
        let together = self.together.get_mut(group as usize)?;
        if together.is_new {
            together.is_new = false;
            let found = (*together.values.first_chunk::<N>()?, together.arrived);
            *self.new.get_mut(group as usize)? = 0;
            return Some(found);
        }
        let all = members.iter().fold(0, |all, member| all | bit(*member));
        let new = *self.new.get(group as usize)?;
        if new & all != all {
            return None;
        }
        let values = members.map(|member| self.value(member));
        let newest = values.iter().map(|value| value.arrived).max()?;
        let last = self.together.get(group as usize)?.arrived;
        if !last.is_never() && newest.since(last) <= TOGETHER_WITHIN {
            return None;
        }
        *self.new.get_mut(group as usize)? = 0;
        let oldest = values.iter().map(|value| value.arrived).min()?;
        Some((values.map(|value| value.value), oldest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at_ms(ms: i64) -> Time {
        Time::from_nanos(1_000_000_000 + ms * 1_000_000)
    }

    fn frame(values: &mut Values, at: Time, of: &[(Quantity, f64)]) {
        values.begin_frame();
        for (quantity, value) in of {
            values.set(*quantity, *value, at);
        }
        values.end_frame();
    }

    const PITCH: Quantity = Quantity::Pitch;
    const ROLL: Quantity = Quantity::Roll;

    #[test]
    fn the_groups_are_in_the_order_of_their_numbers() {
        for (number, group) in Group::ALL.into_iter().enumerate() {
            assert_eq!(group as usize, number, "{group:?}");
            assert!(group.members().len() <= MOST_MEMBERS);
        }
    }

    #[test]
    fn members_that_never_come_together_are_as_old_as_the_oldest() {
        let mut values = Values::default();
        frame(&mut values, at_ms(0), &[(PITCH, 0.1)]);
        assert_eq!(values.whole::<2>(Group::Attitude), None);
        frame(&mut values, at_ms(10), &[(ROLL, 0.2)]);
        let mixed = values.whole(Group::Attitude);
        assert_eq!(mixed, Some(([0.1, 0.2], at_ms(0))));
        assert_eq!(values.whole::<2>(Group::Attitude), None, "returned once");
        frame(&mut values, at_ms(20), &[(ROLL, 0.3)]);
        assert_eq!(values.whole::<2>(Group::Attitude), None, "pitch is old");
    }

    /// At 144 frames a second with values of 100 Hz, seven frames in ten have
    /// one of two values, and four have both.
    #[test]
    fn a_group_is_of_the_last_frame_that_had_all_of_it() {
        let mut values = Values::default();
        frame(&mut values, at_ms(0), &[(PITCH, 0.0), (ROLL, 10.0)]);
        frame(&mut values, at_ms(7), &[(PITCH, 0.7)]);
        let whole = values.whole(Group::Attitude);
        assert_eq!(whole, Some(([0.0, 10.0], at_ms(0))));
        frame(&mut values, at_ms(14), &[(ROLL, 11.4)]);
        assert_eq!(values.whole::<2>(Group::Attitude), None, "of two frames");
        frame(&mut values, at_ms(21), &[(PITCH, 2.1), (ROLL, 12.1)]);
        let whole = values.whole(Group::Attitude);
        assert_eq!(whole, Some(([2.1, 12.1], at_ms(21))));
    }

    #[test]
    fn once_no_frame_has_had_a_group_for_a_tenth_of_a_second_frames_are_mixed() {
        let mut values = Values::default();
        frame(&mut values, at_ms(0), &[(PITCH, 0.0), (ROLL, 0.0)]);
        assert!(values.whole::<2>(Group::Attitude).is_some());
        let mut first = None;
        for n in 1..20 {
            let at = at_ms(n * 10);
            let one = if n % 2 == 0 { PITCH } else { ROLL };
            frame(&mut values, at, &[(one, n as f64)]);
            if values.whole::<2>(Group::Attitude).is_some() {
                first = first.or(Some(n * 10));
            }
        }
        assert_eq!(first, Some(110));
    }

    #[test]
    fn groups_that_share_a_member_do_not_take_it_from_each_other() {
        let mut values = Values::default();
        let all = [
            Quantity::AccelerationEast,
            Quantity::AccelerationUp,
            Quantity::AccelerationSouth,
            Quantity::LocalHeading,
            PITCH,
            ROLL,
        ];
        frame(&mut values, at_ms(0), &all.map(|quantity| (quantity, 0.1)));
        assert!(values.whole::<2>(Group::Attitude).is_some());
        assert!(values.whole::<6>(Group::Acceleration).is_some());
    }
}
