"""The suite's flights: the matrix of aircraft, conditions, sensors and initial states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ..campaign.aircraft import AIRCRAFT
from ..configurations import configuration, pattern_of, with_values
from ..initial_state import InitialState
from ..lockstep import Scenario
from ..peer import PEER_AIRCRAFT
from ..plant import Weather
from .limit_table import EDGES, ROUGH, SMOOTH, TAKEN_OVER, late
from .limits import Limits, limits

SEEDS = (4101, 4102, 4103, 4104, 4105)
TUNING_SEEDS = (
    *(1, 2, 3, 101, 102),
    *range(300, 308),
    *range(500, 516),
    *range(900, 910),
    *range(2026, 2031),
)
"""Seeds used for tuning, none of which is in SEEDS."""

CESSNAS = ("c172p", "c172x")
LIGHT = (*CESSNAS, "c172r", "J3Cub")
HEAVY = ("OV10", "t6texan2", "T37", "c310", "737", "global5000")

_LIGHT_LEGS = 8
_HEAVY_LEGS = 4
_SIDES_DEG = (0.0, 90.0, 180.0, 270.0)
_WIND_KT = 10.0
_DELAY_TICKS = 1
_LONG_DELAY_TICKS = 4
_NARROW_BANK_DEG = 20.0


@dataclass(frozen=True)
class Case:
    """A scenario, flown once for each seed, and its limits."""

    name: str
    group: str
    """Cases of one group are together in the table."""
    scenario: Scenario
    limits: Limits
    seeds: tuple[int, ...] = SEEDS[:1]
    """The legs of all flights are judged together."""
    is_peer: bool = False
    """Flown by JSBSim's own autopilot."""
    is_quick: bool = False
    """Whether it is flown as a test."""


def cases() -> list[Case]:
    """Return all cases, in the order of the table."""
    return [_peer(), *_aircraft(), *_initial_states(), *_narrow_bank(), *_speeds_and_loads()]


def scenario_of(aircraft: str) -> Scenario:
    """Return an aircraft's calm flight with its own configuration and legs."""
    config = configuration(aircraft)
    return Scenario(
        aircraft=aircraft,
        legs=_HEAVY_LEGS if aircraft in HEAVY else _LIGHT_LEGS,
        config=config,
        pattern=pattern_of(config),
    )


def _peer() -> Case:
    return Case(
        name=f"{PEER_AIRCRAFT}: JSBSim's own autopilot, calm",
        group="peer",
        scenario=Scenario(aircraft=PEER_AIRCRAFT),
        limits=limits(),
        is_peer=True,
    )


def _aircraft() -> Iterator[Case]:
    for aircraft in (*LIGHT, *HEAVY):
        smooth, rough = SMOOTH[aircraft], ROUGH[aircraft]
        calm = scenario_of(aircraft)
        noisy = replace(calm, noise=True, delay_ticks=_DELAY_TICKS)
        many = SEEDS if aircraft in CESSNAS else SEEDS[:2]
        yield Case(f"{aircraft}: calm", aircraft, calm, smooth, is_quick=True)
        for side_deg in _SIDES_DEG:
            wind = Weather(wind_from_deg=side_deg, wind_kt=_WIND_KT)
            name = f"{aircraft}: {_WIND_KT:.0f} kt from {side_deg:.0f}°"
            yield Case(name, aircraft, replace(calm, weather=wind), smooth)
        yield Case(
            f"{aircraft}: noise, 25 ms late", aircraft, noisy, smooth, seeds=many, is_quick=True
        )
        yield Case(
            f"{aircraft}: noise, 100 ms late",
            aircraft,
            replace(noisy, delay_ticks=_LONG_DELAY_TICKS),
            late(smooth),
            seeds=many,
        )
        for severity, asked in zip((3, 4), rough, strict=True):
            weather = Weather(turbulence_severity=severity)
            yield Case(
                f"{aircraft}: noise, 25 ms late, turbulence {severity}",
                aircraft,
                replace(noisy, weather=weather),
                asked,
                seeds=many,
                is_quick=severity == 3 and aircraft in CESSNAS,
            )


def _initial_states() -> Iterator[Case]:
    """Return cases in which the autopilot engages in another state than trimmed flight."""
    taken = [(aircraft, initial_state) for aircraft in CESSNAS for initial_state in InitialState]
    turning = (InitialState.IN_A_TURN, InitialState.IN_A_CLIMB)
    taken += [
        (aircraft, initial_state) for aircraft in ("OV10", "737") for initial_state in turning
    ]
    for aircraft, initial_state in taken:
        if initial_state is InitialState.TRIMMED:
            continue
        # Legs refer to the trimmed airspeed; here another one is captured.
        asked = limits(
            unsettled_share=0.0,
            mean_altitude_rms_ft=TAKEN_OVER[aircraft],
            hold_heading_error_deg=1.0,
            hold_altitude_error_ft=TAKEN_OVER[aircraft],
            largest_bank_deg=40.0,
            lateral_acceleration_g=0.15,
        )
        yield Case(
            f"{aircraft}: engaged {initial_state.value}",
            "initial states",
            replace(scenario_of(aircraft), legs=2, initial_state=initial_state),
            asked,
            is_quick=aircraft == "c172p",
        )


def _narrow_bank() -> Iterator[Case]:
    """At 20 degrees of bank a turn cannot be finished in its leg.

    Unfinished turns accumulate past half a circle, where the shorter way is the wrong one.
    """
    for aircraft in CESSNAS:
        plain = scenario_of(aircraft)
        config = with_values(plain.config, {"autopilot.envelope.max_bank_deg": _NARROW_BANK_DEG})
        yield Case(
            f"{aircraft}: bank limit {_NARROW_BANK_DEG:.0f}°, turns accumulate",
            "narrow bank",
            replace(plain, config=config, legs=12),
            limits(turned_back_deg=1.0, largest_bank_deg=23.0, mean_altitude_rms_ft=2.0),
            is_quick=True,
        )


def _speeds_and_loads() -> Iterator[Case]:
    """At 1.3 Vs, in cruise and fast, with one person and little fuel, and at the greatest weight.

    A leg takes 30 s, because a turn at the greatest speed takes more than 20, and climbs 60 ft,
    because there is little power left to climb.
    """
    for aircraft in LIGHT:
        limits_of = AIRCRAFT[aircraft]
        plain = scenario_of(aircraft)
        pattern = replace(plain.pattern, leg_s=30.0, climb_ft=60.0)
        config = with_values(
            plain.config,
            {
                "guidance.mode": "timed-pattern",
                "guidance.leg_s": pattern.leg_s,
                "guidance.climb_ft": pattern.climb_ft,
            },
        )
        for weight in ("light", "heavy"):
            loading = limits_of.loading(weight)
            for speed, airspeed_kt in (
                ("1.3 Vs", limits_of.slow_kt(loading.weight_lb)),
                ("cruise", None),
                ("fast", limits_of.fast_kt),
            ):
                yield Case(
                    f"{aircraft}: {speed}, {weight}, noise, 25 ms late",
                    "speeds and loads",
                    replace(
                        plain,
                        legs=4,
                        noise=True,
                        delay_ticks=_DELAY_TICKS,
                        config=config,
                        pattern=pattern,
                        airspeed_kt=airspeed_kt,
                        loading=loading,
                    ),
                    EDGES[aircraft],
                    is_quick=(aircraft, speed) in (("c172r", "1.3 Vs"), ("J3Cub", "fast")),
                )
