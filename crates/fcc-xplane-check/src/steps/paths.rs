//! X-Plane's commands and datarefs that the check uses to do what a person
//! would: as listed in X-Plane's `Resources/plugins/Commands.txt` and
//! `DataRefs.txt`.

pub(super) const PAUSE: &str = "sim/operation/pause_toggle";
pub(super) const MAP: &str = "sim/map/show_current";
pub(super) const SETTINGS: &str = "sim/operation/toggle_settings_window";
pub(super) const REPLAY: &str = "sim/replay/replay_toggle";
pub(super) const ALTIMETER_UP: &str = "sim/instruments/barometer_up";
pub(super) const ALTIMETER_DOWN: &str = "sim/instruments/barometer_down";
pub(super) const SERVOS_ON: &str = "sim/autopilot/servos_on";
pub(super) const SERVOS_OFF: &str = "sim/autopilot/servos_off_any";
pub(super) const RELOAD: &str = "sim/operation/reload_aircraft";
pub(super) const RELOAD_SCENERY: &str = "sim/operation/reload_scenery";

/// The rate of time that is asked for: 1, or 2 for twice as fast.
pub(super) const SIM_SPEED: &str = "sim/time/sim_speed";
pub(super) const GENERIC_LIGHTS: &str = "sim/cockpit2/switches/generic_lights_switch";

/// Lights of a cockpit that every aircraft has.
pub(super) const LIGHTS: [&str; 5] = [
    "sim/cockpit2/switches/landing_lights_on",
    "sim/cockpit2/switches/taxi_light_on",
    "sim/cockpit2/switches/navigation_lights_on",
    "sim/cockpit2/switches/beacon_on",
    "sim/cockpit2/switches/strobe_lights_on",
];
