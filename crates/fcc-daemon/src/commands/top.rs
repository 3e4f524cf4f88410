//! `fccd top`: a flight on this machine, live.

use fcc_live::running;
use fcc_telemetry::Instance;

use super::failure::Failure;
use super::vehicles::Kind;
use crate::cli::TopArgs;
use crate::exit::Exit;

/// Watches a daemon.
pub(super) fn top(args: &TopArgs) -> Result<Exit, Failure> {
    let instance = args.instance.clone();
    let instance = instance.unwrap_or_else(the_one);
    (Kind::published(&instance).watch)(&instance, args.json)
}

/// The only daemon that runs, or else the one without another name.
pub(super) fn the_one() -> Instance {
    one_of(&running())
}

fn one_of(running: &[Instance]) -> Instance {
    match running {
        [one] => one.clone(),
        _ => Instance::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_only_daemon_is_meant_whatever_its_name() {
        let named = |names: &[&str]| names.iter().map(|name| name.parse().unwrap()).collect();
        let one = |names: &[&str]| -> String {
            let running: Vec<Instance> = named(names);
            one_of(&running).to_string()
        };
        assert_eq!(one(&[]), "fccd");
        assert_eq!(one(&["left"]), "left");
        assert_eq!(one(&["fccd", "left"]), "fccd");
        assert_eq!(one(&["left", "right"]), "fccd");
    }
}
