//! The daemon's own observers of a flight.

pub(crate) mod aircraft;
mod announcer;
mod beginning;
mod plan_result;
mod service;
mod status;

pub(crate) use announcer::Announcer;
pub(crate) use beginning::Beginning;
pub(crate) use plan_result::PlanResult;
pub(crate) use service::Service;
pub(crate) use status::StatusLine;

#[cfg(test)]
mod tests {
    use fcc_flight::flight::conformance::observer_conforms;

    use super::*;

    #[test]
    fn every_observer_conforms_to_the_trait() {
        observer_conforms(|| Box::new(Announcer::default()));
        observer_conforms(|| Box::new(Beginning(Vec::new())));
        observer_conforms(|| Box::new(StatusLine::new(aircraft::describe, aircraft::switch, true)));
        observer_conforms(|| Box::new(PlanResult::default()));
        observer_conforms(|| Box::new(Service::from_environment()));
    }
}
