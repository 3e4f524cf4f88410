"""Margins measured with the loop broken at one actuator's command.

A sum of sines is added to the command of one actuator while the autopilot flies in lockstep. At
each of their frequencies the open loop is L = -c/u: c the autopilot's command, u the command with
the sines. Everything else stays closed, so an unstable open loop is no difficulty, and what
adapts in flight has adapted. (Åström and Murray 2008, chapter 9: margins; Pintelon and Schoukens
2012, chapter 2: periodic excitation.)
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import fcc
import numpy as np
from numpy.typing import NDArray

from ..actuation import Actuation, Servos
from ..aircraft import by_name
from ..campaign.aircraft import AIRCRAFT, Limits
from ..configurations import configuration, with_values
from ..lockstep import measurements
from ..plant import STEPS_PER_SECOND, Plant
from ..state import Controls
from ..workers import local_workers

AXES = ("elevator", "aileron", "rudder", "throttle")
WANTED_DB, WANTED_DEG = 6.0, 45.0

_TICK_HZ = 40
_STEPS = 3
_SETTLING_S = 20.0
_HOLDS: dict[str, float | str] = {"guidance.mode": "timed-pattern", "guidance.hold_s": 3_600.0}
"""The timed pattern begins long after the measurement."""


@dataclass(frozen=True)
class _Excitation:
    """Sines of one axis."""

    least_hz: float
    most_hz: float
    period_s: float
    amplitude: float
    """Of each sine, in the actuator's units."""


_SURFACE = _Excitation(0.2, 9.0, 20.0, 0.004)
_EXCITATIONS = {
    "elevator": _SURFACE,
    "aileron": _SURFACE,
    "rudder": _SURFACE,
    "throttle": _Excitation(0.02, 1.0, 100.0, 0.01),
}
_SINES = 28


@dataclass(frozen=True)
class Condition:
    """A flight condition, an actuator, and what is between it and the autopilot."""

    aircraft: str
    airspeed_kt: float
    axis: str
    delay_s: float = 0.025
    servo_hz: float = 3.0
    weight: str = ""
    """"light" or "heavy" as in the campaign; else as JSBSim has it."""


@dataclass(frozen=True)
class Margins:
    """The margins in one condition; infinite if the open loop has no such crossing."""

    condition: Condition
    gain_db: float
    """The least change of gain, up or down, that makes the loop unstable."""
    phase_deg: float
    """The least change of phase that does."""
    crossover_hz: float
    """Of the least phase margin."""
    frequency_hz: tuple[float, ...]
    open_loop: tuple[complex, ...]

    @property
    def holds(self) -> bool:
        """Return whether both are at least 6 dB and 45 degrees."""
        return self.gain_db >= WANTED_DB and self.phase_deg >= WANTED_DEG

    def document(self) -> dict[str, Any]:
        """Return it for JSON."""
        condition = self.condition
        return {
            "aircraft": condition.aircraft,
            "airspeed_kt": condition.airspeed_kt,
            "axis": condition.axis,
            "delay_s": condition.delay_s,
            "servo_hz": condition.servo_hz,
            "weight": condition.weight or None,
            "gain_db": self.gain_db if math.isfinite(self.gain_db) else None,
            "phase_deg": self.phase_deg if math.isfinite(self.phase_deg) else None,
            "crossover_hz": self.crossover_hz if math.isfinite(self.crossover_hz) else None,
            "frequency_hz": list(self.frequency_hz),
            "open_loop": [[point.real, point.imag] for point in self.open_loop],
        }


def limits_of(aircraft: str) -> Limits:
    """Return the weights and speeds of an aircraft. Raises ValueError if they are not known."""
    if aircraft not in AIRCRAFT:
        raise ValueError(
            f"{aircraft}: weights and speeds are known of {', '.join(AIRCRAFT)}; give --airspeeds"
        )
    return AIRCRAFT[aircraft]


def airspeeds_kt(aircraft: str, weight: str = "") -> tuple[float, float, float]:
    """Return 1.3 Vs, or 4 kt above the lowest airspeed permitted, cruise and the greatest airspeed.

    Raises ValueError if they are not known.
    """
    limits = limits_of(aircraft)
    slow_kt = limits.slow_kt(limits.loading(weight or "heavy").weight_lb)
    return round(slow_kt, 1), by_name(aircraft).airspeed_kt, limits.fast_kt


def measure(condition: Condition) -> Margins:
    """Fly a condition and return its margins. Raises ValueError, TrimError and EngageError."""
    if condition.axis not in AXES:
        raise ValueError(f"axis '{condition.axis}': choose one of {', '.join(AXES)}")
    excitation = _EXCITATIONS[condition.axis]
    frequency_hz = _frequencies(excitation)
    command, excited = _fly(condition, excitation, frequency_hz)
    bins = np.round(frequency_hz * excitation.period_s).astype(int)
    open_loop = -np.fft.rfft(command)[bins] / np.fft.rfft(excited)[bins]
    gain_db, phase_deg, crossover_hz = margins_of(frequency_hz, open_loop)
    return Margins(
        condition, gain_db, phase_deg, crossover_hz, tuple(frequency_hz), tuple(open_loop)
    )


def measure_all(conditions: Sequence[Condition], workers: int | None = None) -> Iterator[Margins]:
    """Measure conditions in parallel processes; yield them in their order."""
    with local_workers(measure, workers) as measure_each:
        yield from measure_each(conditions)


def margins_of(
    frequency_hz: NDArray[np.float64], open_loop: NDArray[np.complex128]
) -> tuple[float, float, float]:
    """Return gain margin in dB, phase margin in degrees and its frequency in Hz."""
    log_frequency = np.log(frequency_hz)
    fine = np.linspace(log_frequency[0], log_frequency[-1], 2_000)
    gain = np.interp(fine, log_frequency, 20.0 * np.log10(np.abs(open_loop)))
    phase = np.interp(fine, log_frequency, np.degrees(np.unwrap(np.angle(open_loop))))
    to_minus_one = (phase + 360.0) % 360.0 - 180.0
    crosses_gain = np.nonzero(np.diff(np.sign(gain)))[0]
    crosses_phase = np.nonzero(
        (np.diff(np.sign(to_minus_one)) != 0) & (np.abs(np.diff(to_minus_one)) < 180.0)
    )[0]
    gain_db = float(np.min(np.abs(gain[crosses_phase]), initial=math.inf))
    if not crosses_gain.size:
        return gain_db, math.inf, math.inf
    nearest = crosses_gain[np.argmin(np.abs(to_minus_one[crosses_gain]))]
    return gain_db, float(abs(to_minus_one[nearest])), float(np.exp(fine[nearest]))


def _frequencies(excitation: _Excitation) -> NDArray[np.float64]:
    """Return frequencies of which each has whole cycles in a period."""
    spread = np.geomspace(excitation.least_hz, excitation.most_hz, _SINES)
    cycles: NDArray[np.float64] = np.unique(np.round(spread * excitation.period_s))
    return cycles / excitation.period_s


def _fly(
    condition: Condition, excitation: _Excitation, frequency_hz: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the autopilot's command and the excited command of one period."""
    name, weight = condition.aircraft, condition.weight
    loading = limits_of(name).loading(weight) if weight else None
    plant = Plant(replace(by_name(name), airspeed_kt=condition.airspeed_kt, loading=loading))
    autopilot = fcc.Autopilot(with_values(configuration(name), _HOLDS))
    for _ in range(2 * _TICK_HZ):
        autopilot.observe(measurements(plant.state()))
        plant.step(_STEPS)
    stand = plant.controls
    autopilot.engage(
        measurements(plant.state()),
        throttle=stand.throttle,
        elevator=stand.elevator,
        aileron=stand.aileron,
        rudder=stand.rudder,
    )
    latency_steps = round(condition.delay_s * STEPS_PER_SECOND)
    servos = Servos(Actuation(latency_steps, condition.servo_hz or None), plant.controls)
    phases = np.random.default_rng(3).uniform(0.0, 2.0 * np.pi, frequency_hz.size)
    ticks = round((_SETTLING_S + excitation.period_s) * _TICK_HZ)
    time_s = np.arange(ticks) / _TICK_HZ
    sines = np.sin(2.0 * np.pi * np.outer(time_s, frequency_hz) + phases).sum(axis=1)
    added = excitation.amplitude * np.minimum(time_s / 3.0, 1.0) * sines
    commands, excited = np.empty(ticks), np.empty(ticks)
    for tick in range(ticks):
        wanted = autopilot.step(measurements(plant.state()))
        command = Controls(
            elevator=wanted.elevator,
            aileron=wanted.aileron,
            rudder=wanted.rudder,
            throttle=wanted.throttle,
        )
        commands[tick] = getattr(command, condition.axis)
        excited[tick] = commands[tick] + added[tick]
        command = replace(command, **{condition.axis: float(excited[tick])})
        for _ in range(_STEPS):
            plant.write(servos.step(command))
            plant.step()
    begin = ticks - round(excitation.period_s * _TICK_HZ)
    return commands[begin:], excited[begin:]
