//! Contingencies: what the autopilot does by itself when the flight cannot go on as it
//! was commanded, though it can be controlled.
//!
//! | contingency | its trigger | when it ends |
//! |---|---|---|
//! | `PositionLost` | dead reckoning for longer than configured | with a position: a plan is continued |
//! | `CommanderLost` | no command within the time that one has promised | by a command |
//! | `Fence` | no circle to turn onto stays inside of the fence any more | by a command |
//! | `BatteryLow` | charge or voltage below its limit for longer than configured | by a command |
//! | `EngineOut` | the engine's speed below its limit, or no thrust, for longer than configured | by a command, or with the engine |
//! | `Terrain` | the ground ahead | a climb when it is passed, a turn by a command |
//!
//! The later in this table, the worse; the worst one acts. Each has its action in the
//! configuration; what is not the fence waits for the end of a take-off or landing, and
//! gives the landing up if there is no position. A command ends it: the pilot decides; but
//! while the aircraft turns away from the fence or the ground, it is refused. Near the fence the aircraft turns onto the circle that stays inside of
//! it, by present wind, and returns from there as soon as its course points there; if
//! that brings it to the fence again, it stays on the circle. It turns away from the fence
//! whatever else acts, but a glide; a low battery acts again when the fence is left behind.
//! Without an engine nothing waits for the end of a take-off or landing in the air.

mod battery;
mod config;
mod delayed;
mod engine_out;
mod fence;
mod surface;
mod terrain;

use core::fmt;

use super::Autopilot;
pub use config::{ContingencyAction, ContingencyConfig};
pub(super) use delayed::Delayed;
pub(super) use engine_out::Engine;
use fcc_core::framework::{Notice, PERMILLE};
use fcc_core::schema;
use fcc_guidance::Mode;
use fcc_guidance::route::RunwayReason;
use fence::{KeptCircle, Side};
use terrain::TerrainWatch;

/// The number of their notices: the amount says which, the item what is done.
pub(super) const CONTINGENCY: u8 = 31;
schema! {
    /// What the autopilot does by itself, and why; the worse the greater.
    pub enum Contingency {
        /// Nothing.
        None = 0,
        /// No position was measured for longer than configured.
        PositionLost = 1,
        /// A commander has not kept its promise to be heard.
        CommanderLost = 2,
        /// The fence is near, or was crossed.
        Fence = 3,
        /// The battery's charge or voltage is below its limit.
        BatteryLow = 4,
        /// The engine gives no power.
        EngineOut = 5,
        /// The ground is ahead.
        Terrain = 6,
    }
}

/// How far a contingency is dealt with.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum Stage {
    /// As its action says.
    #[default]
    Acting,
    /// On the circle that stays inside of the fence, until it can return.
    TurningAway,
    /// It has left that, and there was no room for another one yet.
    Leaving,
    /// On it for good.
    Staying,
}

impl Stage {
    /// Whether the aircraft is on the circle that it has turned onto.
    const fn is_on_circle(self) -> bool {
        matches!(self, Self::TurningAway | Self::Staying)
    }
}

/// The contingencies of a flight.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contingencies {
    active: Contingency,
    stage: Stage,
    /// The mode that it has commanded, and the one before.
    mode: Mode,
    before: Mode,
    /// Whether this loss of the position was acted on.
    is_loss_met: bool,
    /// The indicated airspeed without gusts, m/s.
    airspeed_mps: Option<f64>,
    /// How often it was turned away from the fence since it was met.
    turns: u8,
    /// Whether this low battery was acted on.
    is_battery_met: bool,
    /// Of a fence that is not acted on.
    side: Side,
    /// Whether it was engaged outside of the fence and has not come in; none before it is
    /// known.
    enters_fence: Option<bool>,
    /// Whether this engine failure was acted on.
    is_engine_met: bool,
    /// Within which time commands are promised, and how much of it is left, s.
    promised_s: Option<(f64, f64)>,
    /// The circle at the fence that was turned onto, until it is left behind.
    kept: Option<KeptCircle>,
    /// The ground ahead.
    terrain: TerrainWatch,
    /// The share of the turns' bank that low airspeed and gusts have not allowed of late.
    bank_missing: f64,
}

impl Contingencies {
    /// The active one, or that the ground ahead is climbed over.
    pub(super) const fn active(&self) -> Contingency {
        if self.terrain.climbs() {
            return Contingency::Terrain;
        }
        self.active
    }

    /// Whether a command may end the turn away from the ground: when it is not ahead any more.
    pub(super) fn may_leave_terrain(&self) -> bool {
        self.active != Contingency::Terrain
            || !self.stage.is_on_circle()
            || !self.terrain.is_in_the_way
    }

    /// The lowest altitude above mean sea level that the ground ahead permits, m.
    pub(super) const fn lowest_over_terrain_m(&self) -> Option<f64> {
        self.terrain.lowest_m()
    }

    /// A new engagement begins. What a commander has promised begins anew.
    pub(super) const fn reset(&mut self) {
        let promised_s = self.promised_s;
        *self = Self {
            active: Contingency::None,
            stage: Stage::Acting,
            mode: Mode::None,
            before: Mode::None,
            is_loss_met: false,
            airspeed_mps: None,
            turns: 0,
            is_battery_met: false,
            side: Side::Inside,
            enters_fence: None,
            is_engine_met: false,
            promised_s,
            kept: None,
            terrain: TerrainWatch::NONE,
            bank_missing: 0.0,
        };
        self.renew_promise();
    }

    /// A commander promises to be heard within this time, s; 0: not any more.
    pub(super) fn promise(&mut self, within_s: f64) {
        self.promised_s = (within_s > 0.0).then_some((within_s, within_s));
    }

    /// A command was received.
    pub(super) const fn renew_promise(&mut self) {
        if let Some((within_s, left_s)) = &mut self.promised_s {
            *left_s = *within_s;
        }
    }

    /// The pilot has commanded what is flown now.
    pub(super) const fn end(&mut self) {
        self.active = Contingency::None;
        self.stage = Stage::Acting;
    }
}

/// The notice of a contingency and of what is done.
fn notice(which: Contingency, action: ContingencyAction) -> Notice {
    Notice {
        kind: CONTINGENCY,
        amount_permille: which as u16 * PERMILLE,
        item: action as u16 + 1,
        ..Notice::default()
    }
}

impl Autopilot {
    /// Whether a command may end what is done: a turn away from the fence or the ground
    /// comes first, until it has led away.
    pub(super) fn may_end_contingency(&self) -> bool {
        self.may_leave_fence() && self.supervisor.contingencies.may_leave_terrain()
    }

    /// Finds contingencies, and acts on the worst.
    pub(super) fn meet_contingencies(&mut self) {
        let dt_s = self.intake.clock.passed_s();
        if dt_s <= 0.0 {
            return;
        }
        self.follow_bank(dt_s);
        self.keep_inside_fence();
        self.meet_engine_out();
        self.meet_low_battery();
        self.watch_commander(dt_s);
        self.watch_position();
        self.keep_clear_of_terrain(dt_s);
    }

    /// Acts on a contingency, unless a worse one is dealt with. A take-off or a landing is
    /// ended before; whether it is acted on.
    fn meet(&mut self, contingency: Contingency, action: ContingencyAction) -> bool {
        self.meet_as(contingency, action, contingency as u16 * PERMILLE)
    }

    /// The same, reported with another amount.
    fn meet_as(
        &mut self,
        contingency: Contingency,
        action: ContingencyAction,
        amount_permille: u16,
    ) -> bool {
        if self.guidance.runway().is_some() {
            return false;
        }
        if self.supervisor.contingencies.active as u8 >= contingency as u8 {
            return true;
        }
        self.begin_contingency(contingency, action, amount_permille);
        true
    }

    fn begin_contingency(
        &mut self,
        contingency: Contingency,
        action: ContingencyAction,
        amount_permille: u16,
    ) {
        self.supervisor.contingencies.active = contingency;
        self.supervisor.contingencies.stage = Stage::Acting;
        self.supervisor.contingencies.before = self.guidance.mode.mode();
        let action = self.act(action);
        self.supervisor.contingencies.mode = self.guidance.mode.mode();
        self.journal.add(Notice {
            amount_permille,
            ..notice(contingency, action)
        });
    }

    /// Begins what an action says; what was begun.
    fn act(&mut self, action: ContingencyAction) -> ContingencyAction {
        match action {
            ContingencyAction::Continue => {}
            ContingencyAction::Loiter => self.pause(),
            ContingencyAction::Land if self.fly_landing() => {}
            ContingencyAction::Glide => self.glide(),
            ContingencyAction::Return | ContingencyAction::Land => {
                self.return_home();
                return ContingencyAction::Return;
            }
        }
        action
    }

    fn watch_position(&mut self) {
        let config = self.config.contingency;
        if self.estimator.ground.is_measured() {
            self.supervisor.contingencies.is_loss_met = false;
            if self.supervisor.contingencies.active == Contingency::PositionLost {
                let is_left = self.supervisor.contingencies.before == Mode::Plan
                    && self.guidance.mode.mode() == self.supervisor.contingencies.mode
                    && self.guidance.mode.mode() != Mode::Plan;
                self.supervisor.contingencies.end();
                let found = notice(Contingency::None, ContingencyAction::Continue);
                self.journal.add(found);
                if is_left {
                    self.fly_plan(0);
                }
            }
            return;
        }
        if self.supervisor.contingencies.is_loss_met
            || self.estimator.ground.here().is_none()
            || self.estimator.ground.lost_s() < config.position_after_s
        {
            return;
        }
        // Headings and altitudes are flown without one.
        let action = if self.guidance.mode.over_ground().is_some() {
            config.position
        } else {
            ContingencyAction::Continue
        };
        // Where the runway is, is not known well enough.
        if action != ContingencyAction::Continue {
            self.guidance.mode.go_around(RunwayReason::NoPosition);
        }
        self.supervisor.contingencies.is_loss_met = self.meet(Contingency::PositionLost, action);
    }

    fn watch_commander(&mut self, dt_s: f64) {
        let Some((within_s, left_s)) = self.supervisor.contingencies.promised_s else {
            return;
        };
        let (before_s, left_s) = (left_s, left_s - dt_s);
        let action = self.config.contingency.commander;
        let is_met = left_s <= 0.0 && self.meet(Contingency::CommanderLost, action);
        if !is_met && left_s <= 0.0 && before_s > 0.0 {
            // A take-off or a landing is ended before.
            let lost = notice(Contingency::CommanderLost, ContingencyAction::Continue);
            self.journal.add(lost);
        }
        self.supervisor.contingencies.promised_s = (!is_met).then_some((within_s, left_s));
    }
}

/// Writes the notice of a contingency.
pub(super) fn write(notice: &Notice, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let which = u8::try_from(notice.amount_permille / PERMILLE).unwrap_or_default();
    let what = match Contingency::from_number(which).unwrap_or_default() {
        Contingency::None => "there is a position again",
        Contingency::PositionLost => "there is no position for too long",
        Contingency::CommanderLost => "command link lost, no heartbeat in time",
        Contingency::Fence if notice.item == ContingencyAction::Continue as u16 + 1 => {
            "the fence is crossed"
        }
        Contingency::Fence if notice.amount_permille == fence::OUTSIDE => "outside of the fence",
        Contingency::Fence => "the fence is near: turning away",
        Contingency::BatteryLow => "the battery is low",
        Contingency::EngineOut if notice.amount_permille == engine_out::ENGINE_RUNS => {
            "the engine runs again"
        }
        Contingency::EngineOut if notice.amount_permille == engine_out::SPEED_DOUBTED => {
            "the engine's speed fell to nothing at once: not believed, the thrust decides"
        }
        Contingency::EngineOut => "the engine is out",
        Contingency::Terrain if notice.item == terrain::CLIMBS => {
            return f.write_str("terrain is ahead: climbing");
        }
        Contingency::Terrain if notice.item == terrain::PASSED => {
            return f.write_str("the terrain that was ahead is passed");
        }
        Contingency::Terrain => "terrain is ahead: turning away",
    };
    let action = usize::from(notice.item).checked_sub(1);
    let action = action.and_then(|n| ContingencyAction::ALL.get(n));
    match action {
        Some(action) => write!(f, "{what}: {}", action.name()),
        None => f.write_str(what),
    }
}
