//! Events about the controller: changes of its mode and of its conditions.

use fcc_core::framework::{Controller, EventKind, Flags, Tick};

use crate::machine::Machine;

impl<C: Controller> Machine<C> {
    /// Reports a change of the controller's mode.
    pub(crate) fn report_mode(&mut self, tick: &Tick) {
        let (from, to) = (self.mode, self.controller.mode());
        if from != to {
            self.mode = to;
            let kind = EventKind::ModeChanged { from, to };
            self.telemetry.events.push(tick, kind);
        }
    }

    /// Reports the controller's conditions while control is held; those that
    /// hold at engagement, too.
    pub(crate) fn report_conditions(&mut self, tick: &Tick) {
        let before = self.conditions;
        self.conditions = if self.state.holds_control() {
            self.controller.conditions(tick, &self.measurements)
        } else {
            Flags::NONE
        };
        if self.state.holds_control() && self.conditions != before {
            let [now, before] = [self.conditions.bits(), before.bits()];
            let kind = EventKind::ConditionsChanged {
                began: Flags::from_bits(now & !before),
                ended: Flags::from_bits(before & !now),
            };
            self.telemetry.events.push(tick, kind);
        }
    }
}
