//! What a replay of a flight needs: the autopilot of the recorded configuration.
//! How it is replayed and compared is in [`fcc_replay`].

use fcc_fixed_wing::Autopilot;
use fcc_guidance::{GuidanceConfig, TimedPatternConfig};
use fcc_navigation::inertial::RawNavigationConfig;
use fcc_record::About;
use fcc_replay::{Chain, Replay};
use fcc_timer::TimerError;

use crate::config::{Config, ConfigError, NavigationMethod};

/// The configuration in the recording cannot be read by this version.
#[derive(thiserror::Error, Debug)]
#[error(
    "the configuration in the recording cannot be read by this version of fccd: replay it with the \
     one that recorded it, {by}:\n{error}"
)]
pub struct RecordedConfigError {
    by: String,
    error: ConfigError,
}

/// The configuration that was flown, defaults and command line included.
///
/// # Errors
/// When this version cannot read it, or the elevations that it was flown over are gone.
pub fn recorded_config(chain: &Chain) -> Result<Config, RecordedConfigError> {
    let name = chain.config_name();
    let about = chain.about();
    Config::parse(&about.config, &name)
        .and_then(|config| config.with_recorded_terrain(&name))
        .map_err(|error| RecordedConfigError {
            by: format!("{} ({})", about.software, about.git_hash),
            error,
        })
}

/// The pattern in a recorded configuration; one of another version may be
/// invalid, and then there is no pattern.
pub fn recorded_pattern(about: &About) -> Option<TimedPatternConfig> {
    let config = Config::parse_autopilot(&about.config, "the recording").ok()?;
    match config.guidance {
        GuidanceConfig::TimedPattern(pattern) => Some(pattern),
        GuidanceConfig::Hold | GuidanceConfig::Plan => None,
    }
}

/// The flight plan in a recorded configuration, and which it is in words.
pub fn recorded_plan(about: &About) -> Option<(String, fcc_plan::Plan)> {
    let config = Config::parse_without_aircraft(&about.config, "the recording").ok()?;
    let (identity, plan) = (config.plan.identity()?, config.plan.plan()?);
    let uploaded = fcc_record::timestamp(identity.uploaded_s.saturating_mul(1_000_000_000));
    let which = format!(
        "The flight plan {:.12} has {} items and was uploaded {uploaded}.",
        identity.hash,
        plan.items.len()
    );
    Some((which, plan.clone()))
}

/// How navigation computes from raw readings, with the rest of this configuration.
pub fn navigation_by_raw(config: &Config) -> Option<RawNavigationConfig> {
    let mut config = config.clone();
    config.navigation.method = NavigationMethod::Kalman;
    config.autopilot_config().raw_navigation
}

/// A replay of a flight by this configuration.
///
/// # Errors
/// When the period cannot be kept statistics of.
pub fn replay(config: &Config) -> Result<Replay<Autopilot>, TimerError> {
    let flown = config.clone();
    let replay = Replay::new(
        Autopilot::new(config.autopilot_config()),
        config.tick.period(),
        &config.loop_config(),
    )?;
    // Plans that replaced the first one.
    Ok(replay.with_documents(move |document| flown.prepare_recorded(document)))
}
