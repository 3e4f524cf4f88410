"""The speed of a flight in lockstep, and how the time is spent."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import asdict, dataclass

import fcc

from ..lockstep import Scenario, fly, measurements
from ..plant import Plant
from ..truth import STEPS_PER_ROW, TRUTH_HZ

_ROUNDS = 3


@dataclass(frozen=True)
class Speed:
    """Processor time of one flight in lockstep, the best of three, s, in one process."""

    simulated_s: float
    whole_s: float
    """The whole flight, with trimming and scoring."""
    jsbsim_s: float
    """The same steps of JSBSim without a pilot."""
    properties_s: float
    """Reading its state in every tick."""
    autopilot_s: float
    """The autopilot's steps, called from Python."""

    @property
    def times_real_time(self) -> float:
        """Simulated seconds per second of processor time."""
        return self.simulated_s / self.whole_s

    def words(self) -> str:
        """Return it as text."""
        rest_s = self.whole_s - self.jsbsim_s - self.properties_s - self.autopilot_s
        return (
            f"{self.times_real_time:.0f} times real time with JSBSim on one processor: "
            f"{self.simulated_s:.0f} s flown in {self.whole_s:.2f} s, of which JSBSim's steps "
            f"{self.jsbsim_s / self.whole_s:.0%}, reading its state "
            f"{self.properties_s / self.whole_s:.0%}, the autopilot "
            f"{self.autopilot_s / self.whole_s:.1%}, the rest "
            f"{max(0.0, rest_s) / self.whole_s:.0%}"
        )

    def document(self) -> dict[str, float]:
        """Return it for JSON."""
        return {**asdict(self), "times_real_time": self.times_real_time}


def measure(scenario: Scenario) -> Speed:
    """Measure a scenario's flight."""
    simulated_s = fly(scenario)[1]["time_s"][-1]
    ticks = round(float(simulated_s) * TRUTH_HZ)
    return Speed(
        simulated_s=float(simulated_s),
        whole_s=_best(lambda: fly(scenario)),
        jsbsim_s=_of_jsbsim(scenario.aircraft, ticks),
        properties_s=_of_properties(scenario.aircraft, ticks),
        autopilot_s=_of_autopilot(scenario, ticks),
    )


def _best(work: Callable[[], object]) -> float:
    taken_s = []
    for _ in range(_ROUNDS):
        began_s = time.process_time()
        work()
        taken_s.append(time.process_time() - began_s)
    return min(taken_s)


def _of_jsbsim(aircraft: str, ticks: int) -> float:
    # Without a pilot each round starts again in trim.
    plants = [Plant(aircraft) for _ in range(_ROUNDS)]
    return _best(lambda: plants.pop().step(ticks * STEPS_PER_ROW))


def _of_properties(aircraft: str, ticks: int) -> float:
    plant = Plant(aircraft)
    return _best(lambda: deque((plant.state() for _ in range(ticks)), maxlen=0))


def _of_autopilot(scenario: Scenario, ticks: int) -> float:
    plant = Plant(scenario.aircraft)
    level = measurements(plant.state())
    autopilot = fcc.Autopilot(scenario.config)
    for _ in range(2 * TRUTH_HZ):
        autopilot.observe(level)
    autopilot.engage(level, throttle=plant.trim.throttle)
    return _best(lambda: deque((autopilot.step(level) for _ in range(ticks)), maxlen=0))
