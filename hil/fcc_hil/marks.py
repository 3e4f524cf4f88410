"""The marks `aircraft` and `autopilot` of a test, checked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .aircraft import by_name
from .pattern import TimedPattern
from .plant import Weather
from .quantities import finite
from .standin import Settings

MODES = ("timed-pattern", "hold", "plan")

_STRONGEST_WIND_KT = 100.0
_MOST_SEVERE = 7
_LARGEST_SEED = 2**31 - 1
_LONGEST_S = 86_400.0


def _within(name: str, value: object, least: float, most: float, unit: str) -> float:
    number = finite(name, value)
    if not least <= number <= most:
        raise ValueError(f"{name} is {number:g}: give {least:g} to {most:g} {unit}".rstrip())
    return number


def _whole(name: str, value: object, most: int) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"{name} is {value!r}: give a whole number")
    if not 0 <= value <= most:
        raise ValueError(f"{name} is {value}: give 0 to {most}")
    return value


def aircraft_mark(
    name: str = "c172p",
    *,
    wind: Sequence[float] = (0.0, 0.0),
    turbulence: int = 0,
    seed: int = 1,
    noise: bool = False,
    heading: float = 0.0,
) -> Settings:
    """Return the aircraft of the mark; raise ValueError or TypeError for a wrong argument.

    `name` is one of JSBSim's in the table; `wind` is direction (deg, true) and speed (kt);
    `turbulence` 0 calm, 3 light, 4 moderate, to 7; `seed` is for all random sequences; `noise` is
    that of a phone's sensors; `heading` is the initial one (deg).
    """
    if not isinstance(name, str):
        raise TypeError(f"aircraft is {name!r}: give the name of one")
    by_name(name)
    if isinstance(wind, str) or not isinstance(wind, Sequence) or len(wind) != 2:
        raise TypeError(f"wind is {wind!r}: give from where (deg) and how strong (kt), (270, 10)")
    if not isinstance(noise, bool):
        raise TypeError(f"noise is {noise!r}: give True or False")
    return Settings(
        aircraft=name,
        seed=_whole("seed", seed, _LARGEST_SEED),
        heading_deg=_within("heading", heading, 0.0, 360.0, "deg"),
        weather=Weather(
            wind_from_deg=_within("wind from", wind[0], 0.0, 360.0, "deg"),
            wind_kt=_within("wind", wind[1], 0.0, _STRONGEST_WIND_KT, "kt"),
            turbulence_severity=_whole("turbulence", turbulence, _MOST_SEVERE),
        ),
        noise=noise,
    )


@dataclass(frozen=True)
class AutopilotMark:
    """The autopilot's settings; on another host, those that the daemon there already has."""

    pattern: TimedPattern | None
    """None to hold the captured state."""
    failsafe_hold_s: float
    """How long failsafe holds the wings level before the controls are released."""
    all_silent_s: float
    """How long a simulator from which nothing arrives is waited for."""
    degraded_s: float
    """How long at most it flies on without a sensor. At 0 a failsafe is seen from outside, by its
    release."""
    config: str
    """More sections of a configuration."""
    plan: Path | None = None
    """The flight plan that is flown; None for another mode."""

    def toml(self) -> str:
        """Return it as sections of a configuration file."""
        pattern = self.pattern
        if self.plan is not None:
            file = str(self.plan).replace("\\", "\\\\").replace('"', '\\"')
            flown = f'mode = "plan"\n[plan]\nfile = "{file}"'
        elif pattern is None:
            flown = 'mode = "hold"'
        else:
            flown = (
                f'mode = "timed-pattern"\nhold_s = {pattern.hold_s!r}\nleg_s = {pattern.leg_s!r}\n'
                f"turn_deg = {pattern.turn_deg!r}\nclimb_ft = {pattern.climb_ft!r}"
            )
        failsafe = (
            f"[failsafe]\nhold_s = {self.failsafe_hold_s!r}\nall_silent_s = {self.all_silent_s!r}\n"
            f"degraded_s = {self.degraded_s!r}"
        )
        more = self.config if "[failsafe]" in self.config else f"[failsafe]\n{self.config}"
        return f"[guidance]\n{flown}\n{more.replace('[failsafe]', failsafe, 1)}\n"


def autopilot_mark(  # noqa: PLR0913 - the settings of a mark
    mode: str = "timed-pattern",
    *,
    hold_s: float = 20.0,
    leg_s: float = 20.0,
    turn_deg: float = 90.0,
    climb_ft: float = 150.0,
    failsafe_hold_s: float = 5.0,
    all_silent_s: float = 30.0,
    degraded_s: float = 0.0,
    config: str = "",
    plan: str | Path | None = None,
) -> AutopilotMark:
    """Return the autopilot of the mark; raise ValueError or TypeError for a wrong argument.

    The timed pattern holds for `hold_s`, then turns by `turn_deg` (right if positive) every
    `leg_s`, climbs `climb_ft` on every odd leg and descends on every even one. Without a sensor it
    flies on for at most `degraded_s`; by default a failsafe ends in a release, by which it is seen
    on another host, too. The mode `plan` flies the plan in the file `plan`, from its home on, or
    from the runway there. `config` is the text of more sections: gains, limits, the loop's rate.
    """
    if mode not in MODES:
        raise ValueError(f"mode is {mode!r}: choose {' or '.join(MODES)}")
    if (mode == "plan") != (plan is not None):
        raise ValueError('mode "plan" and the file of a plan belong together: give both')
    if not isinstance(config, str):
        raise TypeError(f"config is {config!r}: give the text of a configuration's sections")
    pattern = TimedPattern(
        hold_s=_within("hold_s", hold_s, 0.0, _LONGEST_S, "s"),
        leg_s=_within("leg_s", leg_s, 1.0, _LONGEST_S, "s"),
        turn_deg=_within("turn_deg", turn_deg, -179.0, 179.0, "deg"),
        climb_ft=_within("climb_ft", climb_ft, -5_000.0, 5_000.0, "ft"),
    )
    return AutopilotMark(
        pattern=pattern if mode == MODES[0] else None,
        failsafe_hold_s=_within("failsafe_hold_s", failsafe_hold_s, 0.0, 600.0, "s"),
        all_silent_s=_within("all_silent_s", all_silent_s, 0.25, 600.0, "s"),
        degraded_s=_within("degraded_s", degraded_s, 0.0, _LONGEST_S, "s"),
        config=config,
        plan=None if plan is None else Path(plan).resolve(),
    )
