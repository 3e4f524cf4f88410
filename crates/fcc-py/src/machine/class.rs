//! A loop as a class of Python.

/// Declares a class around the [`Lockstep`](super::Lockstep) of a controller,
/// with what the loops of all controllers have in common. Its own constructor,
/// steps and commands are given as methods. Needs pyo3's prelude and
/// `LoopCommand` in scope.
#[macro_export]
macro_rules! machine_class {
    (
        $(#[$meta:meta])*
        struct $name:ident($controller:ty) {
            $($(#[doc = $fdoc:literal])* $field:ident: $type:ty,)*
        }
        setpoints $setpoints:ty $(, estimate $estimate:ty)?;
        $($methods:tt)*
    ) => {
        $(#[$meta])*
        pub(crate) struct $name {
            // For one thread at a time, as `&mut self` is.
            lockstep: std::sync::Mutex<$crate::machine::Lockstep<$controller>>,
            $($(#[doc = $fdoc])* $field: $type,)*
        }

        impl $name {
            fn lockstep(&mut self) -> &mut $crate::machine::Lockstep<$controller> {
                let lockstep = self.lockstep.get_mut();
                lockstep.unwrap_or_else(std::sync::PoisonError::into_inner)
            }
        }

        #[pymethods]
        impl $name {
            $($methods)*

            /// Commands the loop to engage in the next tick, if there is no engage
            /// inhibit.
            fn engage(&mut self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Engage)
            }

            /// Commands the loop to disengage in the next tick.
            fn disengage(&mut self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Disengage)
            }

            /// Commands the loop to disengage and end in the next tick.
            fn stop(&mut self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Stop)
            }

            /// The events since the last call.
            fn events(&mut self) -> Vec<$crate::events::PyEvent> {
                self.lockstep().events()
            }

            /// The records of all ticks so far, as a structured array: a column
            /// for each value of the schema.
            fn records<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.lockstep().records().into_array(py)
            }

            /// Writes every tick and event so far into `folder`, as the daemon
            /// records; the files. `aircraft` is the name of the plant, `ending`
            /// why the recording ends.
            ///
            /// Raises `OSError` if the folder cannot be written to.
            #[pyo3(signature = (folder, *, aircraft = "lockstep", ending = "recorded so far"))]
            fn record_to(
                &mut self,
                py: Python<'_>,
                folder: std::path::PathBuf,
                aircraft: &str,
                ending: &str,
            ) -> PyResult<Vec<std::path::PathBuf>> {
                let lockstep = &self.lockstep;
                py.detach(|| {
                    let lockstep = lockstep.lock();
                    let lockstep = lockstep.unwrap_or_else(std::sync::PoisonError::into_inner);
                    lockstep.record_to(folder, aircraft, ending)
                })
            }

            /// standby, engaged, failsafe or stopped.
            #[getter]
            fn state(&mut self) -> String {
                self.lockstep().state().to_string()
            }

            /// The engage inhibits, in words; empty while engaged.
            #[getter]
            fn engage_inhibits(&mut self) -> Vec<&'static str> {
                let inhibits = self.lockstep().record().engage_inhibits;
                $crate::machine::conditions::<$controller>(inhibits)
            }

            /// The faults that make it unsafe to stay engaged, in words; empty in
            /// standby.
            #[getter]
            fn faults(&mut self) -> Vec<&'static str> {
                let faults = self.lockstep().record().faults;
                $crate::machine::conditions::<$controller>(faults)
            }

            /// Whether the loop holds the controls.
            #[getter]
            fn holds_control(&mut self) -> bool {
                self.lockstep().is_held()
            }

            /// The present set points.
            #[getter]
            fn setpoints(&mut self) -> $setpoints {
                self.lockstep().record().setpoints.into()
            }

            $(
                /// The present estimate.
                #[getter]
                fn estimate(&mut self) -> $estimate {
                    self.lockstep().estimated().into()
                }
            )?

            /// The number of the last tick; 0 before the first.
            #[getter]
            fn tick(&mut self) -> u64 {
                self.lockstep().record().tick.number
            }

            /// The loop's clock at the last tick, s.
            #[getter]
            fn time_s(&mut self) -> f64 {
                $crate::events::seconds(self.lockstep().record().tick.woke)
            }

            /// Time from a tick to the next, s.
            #[getter]
            fn period_s(&mut self) -> f64 {
                self.lockstep().period_s()
            }
        }
    };
}
