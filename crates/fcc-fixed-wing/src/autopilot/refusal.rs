//! Why a command is not carried out, and how its sender is told.

use core::fmt;

use libm::fabs;

use super::place_monitor::STANDS_MPS;
use super::{Autopilot, AutopilotCommand};
use fcc_core::flight::atmosphere::pressure_altitude_m;
use fcc_core::framework::{Notice, PERMILLE};
use fcc_guidance::ModeInput;
use fcc_guidance::route::{ALTIMETER_OFF_M, RunwayDemand, RunwayReason};

/// The number of the notice that answers, below those of doubted sensors; the amount is the
/// refusal's number. A plan that
/// is replaced is always answered, with the item that is flown first.
pub const COMMAND_ANSWER: u8 = 0;
/// Lower than this over a runway nothing else is begun, m.
const COMMANDED_M: f64 = 30.0;
/// Air that is 35 K colder or warmer than the standard makes the altimeter wrong by this share
/// of the height.
const AIR_SHARE: f64 = 0.12;

/// Why a command is not carried out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Refusal {
    /// A plan is not replaced.
    NotEngaged = 1,
    NotPrepared,
    NoSuchItem,
    NoPosition,
    TakingOff,
    Landing,
    /// Another command is not carried out.
    OnWheels,
    LowOverRunway,
    NotLanding,
    NoPlan,
    NoItem,
    NowhereKnown,
    TurningAway,
    NoLanding,
    NotBeforeItIsHigher,
    // 16 is not used.
    OffTheReceiver = 17,
}

impl Refusal {
    const ALL: [Self; 16] = [
        Self::NotEngaged,
        Self::NotPrepared,
        Self::NoSuchItem,
        Self::NoPosition,
        Self::TakingOff,
        Self::Landing,
        Self::OnWheels,
        Self::LowOverRunway,
        Self::NotLanding,
        Self::NoPlan,
        Self::NoItem,
        Self::NowhereKnown,
        Self::TurningAway,
        Self::NoLanding,
        Self::NotBeforeItIsHigher,
        Self::OffTheReceiver,
    ];

    const fn words(self) -> &'static str {
        match self {
            Self::NotEngaged => "it is accepted only while engaged",
            Self::NotPrepared => "it was not prepared for this flight",
            Self::NoSuchItem => "it has no such item",
            Self::NoPosition | Self::NowhereKnown => "there is no position",
            Self::TakingOff => {
                "the aircraft is below autopilot.runway.decision_height_ft over its runway, or on \
                 it"
            }
            Self::Landing => "the aircraft is landing: give the landing up first, or wait",
            Self::OnWheels => "the aircraft rolls or stands on its runway; disengaging is possible",
            Self::LowOverRunway => {
                "the aircraft is too low over the runway: it climbs first, command it again then"
            }
            Self::NotLanding => "the aircraft is not landing, or is on its wheels",
            Self::NoPlan => "there is no plan",
            Self::NoItem => "the plan has no such item",
            Self::TurningAway => {
                "the aircraft turns away from the fence or the ground: command it again when it \
                 flies away from there; disengaging is possible"
            }
            Self::NotBeforeItIsHigher => {
                "the height over the runway is measured by the altimeter: set it while the aircraft \
                 stands, or above autopilot.runway.decision_height_ft over the runway"
            }
            Self::OffTheReceiver => {
                "the altimeter would be further off the satellite receiver's altitude, by more \
                 than cold air explains: is it the setting of this place?"
            }
            Self::NoLanding => "the plan has no landing, and the aircraft was not seen to take off",
        }
    }

    /// The refusal of an answer.
    fn of(answer: &Notice) -> Option<Self> {
        let number = answer.amount_permille / PERMILLE;
        Self::ALL.into_iter().find(|one| *one as u16 == number)
    }

    /// Whether a plan is not replaced.
    const fn is_of_plan(self) -> bool {
        self as u16 <= Self::Landing as u16
    }
}

impl Autopilot {
    /// Tells the sender that its command is not carried out.
    pub(super) fn refuse(&mut self, refusal: Refusal) {
        self.answer(refusal as u16, 0);
    }

    /// Tells the sender what became of its command: a refusal's number, or 0.
    pub(super) fn answer(&mut self, refusal: u16, item: u16) {
        self.journal.add(Notice {
            kind: COMMAND_ANSWER,
            amount_permille: refusal * PERMILLE,
            item,
            ..Notice::default()
        });
    }

    /// Whether a command can be carried out now. Low over a runway it would turn the
    /// aircraft: a landing is given up for it.
    pub(super) fn may_carry_out(&mut self, command: &AutopilotCommand) -> Result<(), Refusal> {
        match command {
            AutopilotCommand::Resume(_) | AutopilotCommand::Heartbeat(_) => return Ok(()),
            AutopilotCommand::AltimeterSetting(pa) => return self.may_set_altimeter(*pa),
            AutopilotCommand::GoAround => {
                // A landing that was commanded is not one yet on its way there.
                let next = self
                    .guidance
                    .after(&self.config, ModeInput::GoAround)
                    .filter(|_| self.guidance.is_landing());
                return next.map(drop).ok_or(Refusal::NotLanding);
            }
            AutopilotCommand::Land if self.guidance.is_landing() => return Ok(()),
            _ => {}
        }
        if let Some(demand) = self.guidance.runway() {
            if demand.phase.is_on_wheels() {
                return Err(Refusal::OnWheels);
            }
            if demand.height_m < COMMANDED_M {
                self.guidance.mode.go_around(RunwayReason::Commanded);
                return Err(Refusal::LowOverRunway);
            }
        }
        if !self.may_end_contingency() {
            return Err(Refusal::TurningAway);
        }
        match *command {
            AutopilotCommand::Plan(item) => {
                let plan = self.config.plan.ok_or(Refusal::NoPlan)?;
                let index = usize::from(item.saturating_sub(1));
                plan.step(index).map(drop).ok_or(Refusal::NoItem)
            }
            AutopilotCommand::Pause | AutopilotCommand::ReturnHome | AutopilotCommand::GoTo(_) => {
                let here = self.estimator.ground.here();
                here.map(drop).ok_or(Refusal::NowhereKnown)
            }
            AutopilotCommand::Land => {
                self.estimator.ground.here().ok_or(Refusal::NowhereKnown)?;
                self.has_landing().then_some(()).ok_or(Refusal::NoLanding)
            }
            _ => Ok(()),
        }
    }
}

impl Autopilot {
    /// Whether the altimeter may be set: in a take-off's roll and low over a runway the
    /// height that is flown by would jump. Where a receiver shows the altitude, a setting that
    /// leads far from it is that of another place, or a wrong digit.
    fn may_set_altimeter(&self, setting_pa: f64) -> Result<(), Refusal> {
        let decision_m = self.config.route.runway.decision_height_m;
        let runway = self.guidance.runway();
        let moves = |demand: &RunwayDemand| {
            demand.height_m < decision_m && demand.ground_speed_mps > STANDS_MPS
        };
        if runway.as_ref().is_some_and(moves) {
            return Err(Refusal::NotBeforeItIsHigher);
        }
        let here = self.estimator.ground.here();
        let Some((off_m, altitude_m)) = here.and_then(|here| {
            let off_m = here.above_receiver_m?;
            Some((off_m, here.altitude_m - off_m))
        }) else {
            return Ok(());
        };
        // Cold air makes the altimeter show more by a share of the height above the place whose
        // setting it has.
        let height_m = runway.map_or(altitude_m, |demand| demand.height_m - off_m);
        let lower_m = pressure_altitude_m(setting_pa)
            - pressure_altitude_m(self.guidance.altimeter.setting_pa);
        let would_be_m = fabs(off_m - lower_m);
        let allowed_m = (AIR_SHARE * height_m).max(0.0) + ALTIMETER_OFF_M;
        let is_worse = would_be_m - fabs(off_m) > ALTIMETER_OFF_M;
        if is_worse && would_be_m > allowed_m {
            return Err(Refusal::OffTheReceiver);
        }
        Ok(())
    }
}

/// Why a command is not carried out, if a notice says that.
pub fn why_refused(notice: &Notice) -> Option<&'static str> {
    let refusal = Refusal::of(notice).filter(|_| notice.kind == COMMAND_ANSWER)?;
    Some(refusal.words())
}

/// Writes the answer.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    match (Refusal::of(notice), notice.item) {
        (Some(refusal), _) if refusal.is_of_plan() => {
            write!(f, "the plan is not replaced: {}", refusal.words())
        }
        (Some(refusal), _) => write!(f, "not carried out: {}", refusal.words()),
        (None, _) if notice.amount_permille > 0 => f.write_str("not used (refusal 16)"),
        (None, 0) => f.write_str("the plan is replaced, as before the restart"),
        (None, item) => write!(f, "the plan is replaced, and flown from item {item}"),
    }
}
