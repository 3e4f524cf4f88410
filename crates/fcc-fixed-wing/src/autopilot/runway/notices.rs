//! Notices of a take-off or a landing.

use core::fmt;

use super::RunwayControl;
use fcc_core::framework::Notice;
use fcc_core::units::KNOT_MPS;
use fcc_guidance::route::RunwayReason;

/// The number of their notices: the item is the reason's.
pub(in super::super) const RUNWAY: u8 = 29;

/// More tail wind than this is announced on the approach, kt: the handbooks of the Cessna 172
/// add 10 % of the landing distance for each 2 kt, with this half as much again.
const MOST_TAIL_WIND_KT: f64 = 10.0;

impl RunwayControl {
    /// That a landing has much tail wind, once.
    pub(super) fn watch_tail_wind(
        &mut self,
        approaches: bool,
        head_wind_mps: f64,
    ) -> Option<Notice> {
        let tail_kt = -head_wind_mps / KNOT_MPS;
        let is_new = approaches && tail_kt > MOST_TAIL_WIND_KT && !self.told_wind;
        self.told_wind |= is_new;
        is_new.then(|| Notice {
            amount_permille: (tail_kt + 0.5) as u16,
            ..notice(RunwayReason::TailWind)
        })
    }
}

/// The notice of a reason.
pub(in super::super) fn notice(reason: RunwayReason) -> Notice {
    Notice {
        kind: RUNWAY,
        item: reason as u16,
        ..Notice::default()
    }
}

/// Whether a notice says that the wheels touch the ground where neither a take-off nor a
/// landing is flown.
pub fn touches_ground(notice: &Notice) -> bool {
    notice.kind == RUNWAY && notice.item == RunwayReason::Touched as u16
}

/// Whether a notice says why a take-off or a landing is given up.
pub fn gives_up_runway(notice: &Notice) -> bool {
    let others = [
        RunwayReason::Touched,
        RunwayReason::RangeFinder,
        RunwayReason::NoClimb,
        RunwayReason::TailWind,
        RunwayReason::Strays,
    ];
    notice.kind == RUNWAY && others.iter().all(|other| notice.item != *other as u16)
}

/// Writes the notice of a runway.
pub(in super::super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let number = u8::try_from(notice.item).unwrap_or_default();
    let reason = RunwayReason::from_number(number).unwrap_or_default();
    if reason == RunwayReason::TailWind {
        write!(f, "{} kt of tail wind: ", notice.amount_permille)?;
    }
    write!(f, "{reason}")
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;

    /// Beyond 10 kt the event comes once in a landing, and gives nothing up.
    #[test]
    fn tail_wind_is_told_once_with_its_figure() {
        let mut control = RunwayControl::default();
        let mut told = |approaches, head_kt: f64| {
            control.watch_tail_wind(approaches, head_kt * 1_852.0 / 3_600.0)
        };
        assert_eq!(told(true, -9.9), None);
        assert_eq!(told(false, -15.2), None);
        let notice = told(true, -15.2).unwrap();
        let event = fcc_core::framework::EventKind::Noticed(notice);
        let text = event.description::<crate::Autopilot>().to_string();
        assert!(text.starts_with("15 kt of tail wind: "), "{text}");
        assert!(!gives_up_runway(&notice));
        assert_eq!(told(true, -25.0), None);
    }
}
