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
            lockstep: std::sync::Mutex<$crate::machine::Lockstep<$controller>>,
            $($(#[doc = $fdoc])* $field: $type,)*
        }

        impl $name {
            /// One thread after the other.
            fn lockstep(
                &self,
            ) -> std::sync::MutexGuard<'_, $crate::machine::Lockstep<$controller>> {
                let lockstep = Python::attach(|py| {
                    pyo3::sync::MutexExt::lock_py_attached(&self.lockstep, py)
                });
                lockstep.unwrap_or_else(std::sync::PoisonError::into_inner)
            }
        }

        #[pymethods]
        impl $name {
            $($methods)*

            /// Commands the loop to engage in the next tick, if there is no engage
            /// inhibit.
            fn engage(&self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Engage)
            }

            /// Commands the loop to disengage in the next tick.
            fn disengage(&self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Disengage)
            }

            /// Commands the loop to disengage and end in the next tick.
            fn stop(&self) -> PyResult<()> {
                self.lockstep().send(LoopCommand::Stop)
            }

            /// The events since the last call.
            fn events(&self) -> Vec<$crate::events::PyEvent> {
                self.lockstep().events()
            }

            /// The records of all ticks so far, as a structured array: a column
            /// for each value of the schema.
            fn records<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
                self.lockstep().records().into_array(py)
            }

            /// Writes every tick and event so far into `folder`, as the daemon
            /// records, and returns the files. `aircraft` is the name of the plant,
            /// `ending` the reason for the recording's end.
            ///
            /// Raises `OSError` if the folder cannot be written to.
            #[pyo3(signature = (folder, *, aircraft = "lockstep", ending = "recorded so far"))]
            fn record_to(
                &self,
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
            fn state(&self) -> String {
                self.lockstep().state().to_string()
            }

            /// The engage inhibits, as text; empty while engaged.
            #[getter]
            fn engage_inhibits(&self) -> Vec<&'static str> {
                let inhibits = self.lockstep().record().engage_inhibits;
                $crate::machine::conditions::<$controller>(inhibits)
            }

            /// The faults that make it unsafe to stay engaged, as text; empty in
            /// standby.
            #[getter]
            fn faults(&self) -> Vec<&'static str> {
                let faults = self.lockstep().record().faults;
                $crate::machine::conditions::<$controller>(faults)
            }

            /// Whether the loop holds the controls.
            #[getter]
            fn holds_control(&self) -> bool {
                self.lockstep().is_held()
            }

            /// The present set points.
            #[getter]
            fn setpoints(&self) -> $setpoints {
                self.lockstep().record().setpoints.into()
            }

            $(
                /// The present estimate.
                #[getter]
                fn estimate(&self) -> $estimate {
                    self.lockstep().estimated().into()
                }
            )?

            /// The number of the last tick; 0 before the first.
            #[getter]
            fn tick(&self) -> u64 {
                self.lockstep().record().tick.number
            }

            /// The loop's clock at the last tick, s.
            #[getter]
            fn time_s(&self) -> f64 {
                $crate::events::seconds(self.lockstep().record().tick.woke)
            }

            /// Time from a tick to the next, s.
            #[getter]
            fn period_s(&self) -> f64 {
                self.lockstep().period_s()
            }
        }
    };
}
