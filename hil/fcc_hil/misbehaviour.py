"""How the stand-in misbehaves, one way for each step of `fccd x-plane check`.

Each is an X-Plane, a plugin or a network that is not as it has to be in the respect that the step
checks: the step has to fail.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .cockpit import (
    ALTIMETER_SETTING,
    GENERIC_LIGHTS,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    SERVOS_ON,
    SIM_SPEED,
    YOKE,
    YOKE_ROLL,
)
from .protocol import RunCommand, WriteDataref
from .settings import Mode
from .units import STANDARD_GRAVITY_MPS2

_P = "sim/flightmodel/position/"
_OVERRIDES = (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES)
_FT_PER_INHG = 1_000.0
REPLAY_TOGGLE = "sim/replay/replay_toggle"

Distortion = Callable[[Any, float], float]


def _nothing(_world: Any) -> None:
    """Do nothing in a frame."""


def _all(_world: Any, _message: object) -> bool:
    """Take every message."""
    return True


@dataclass(frozen=True)
class Misbehaviour:
    """What is wrong during a step."""

    does: str
    distorts: Mapping[str, Distortion] = field(default_factory=dict)
    """Datarefs that are sent with other values."""
    withholds: frozenset[str] = frozenset()
    """Datarefs that are not sent."""
    splits: bool = False
    """The values of a frame come in two datagrams."""
    each_frame: Callable[[Any], None] = _nothing
    takes: Callable[[Any, object], bool] = _all
    """Whether a message to the simulator has its effect."""
    ignores_person: bool = False
    """What the person switches off stays on."""
    keeps_overrides: bool = False
    """The overrides stay on, until the step ends."""
    knows_nobody_else: bool = False
    """Only who has subscribed before gets replies."""


def _is_write(message: object, *paths: str) -> bool:
    return isinstance(message, WriteDataref) and message.path in paths


def _connect_lights(world: Any, message: object) -> bool:
    if isinstance(message, WriteDataref) and message.path == f"{GENERIC_LIGHTS}[3]":
        # Every light that a client reads: one of them is the engage switch.
        for paths in world.status()["clients"].values():
            for path in paths:
                if path.startswith(GENERIC_LIGHTS):
                    world.write(path, message.value)
    return True


def _run_too_fast(world: Any, message: object) -> bool:
    if isinstance(message, WriteDataref) and message.path == SIM_SPEED and message.value > 1.0:
        world.cockpit.set(SIM_SPEED, 4.0)
        return False
    return True


def _stay_in_replay(world: Any, message: object) -> bool:
    leaves = isinstance(message, RunCommand) and message.path == REPLAY_TOGGLE
    return not (leaves and world.mode is Mode.REPLAY)


def _keep_overrides(_world: Any, message: object) -> bool:
    return not (isinstance(message, WriteDataref) and message.path in _OVERRIDES) or (
        message.value > 0.5
    )


def _set_overrides_again(world: Any) -> None:
    if world.was_held:
        for path in _OVERRIDES:
            world.cockpit.set(path, 1.0)


def _drop_overrides(world: Any) -> None:
    if world.has_stopped:
        world.cockpit.clear_overrides()


def _follow_joystick(world: Any) -> None:
    pilot = world.cockpit.pilot
    for path, value in zip(YOKE, (pilot.elevator, pilot.aileron, pilot.rudder), strict=True):
        world.cockpit.set(path, value)


def _hold_ailerons(world: Any) -> None:
    world.cockpit.set(YOKE_ROLL, 0.0)


def _by_knob(world: Any, altitude_ft: float) -> float:
    turned_inhg = world.cockpit.read(ALTIMETER_SETTING) - world.settings.qnh_inhg
    return float(altitude_ft + _FT_PER_INHG * turned_inhg)


_DROPS = "releases the controls by itself"

MISBEHAVIOURS: dict[int, Misbehaviour] = {
    1: Misbehaviour("does not send the airspeed", withholds=frozenset({_P + "indicated_airspeed"})),
    2: Misbehaviour("sends the values of a frame in two datagrams", splits=True),
    3: Misbehaviour("takes writes with incoming connections off", ignores_person=True),
    4: Misbehaviour("replies of new connections are dropped", knows_nobody_else=True),
    5: Misbehaviour(
        "has gravity in its accelerations",
        distorts={_P + "local_ay": lambda _, up: up + STANDARD_GRAVITY_MPS2},
    ),
    6: Misbehaviour("sends bank with the other sign", distorts={_P + "phi": lambda _, deg: -deg}),
    7: Misbehaviour("has a reversed roll axis", distorts={YOKE_ROLL: lambda _, ratio: -ratio}),
    8: Misbehaviour("connects another light with the engage switch", takes=_connect_lights),
    9: Misbehaviour(
        "ignores override_throttles", takes=lambda _, m: not _is_write(m, OVERRIDE_THROTTLES)
    ),
    10: Misbehaviour("moves the controls by the joystick", each_frame=_follow_joystick),
    11: Misbehaviour("keeps its ailerons centred", each_frame=_hold_ailerons),
    12: Misbehaviour(_DROPS, each_frame=_drop_overrides),
    13: Misbehaviour(_DROPS, each_frame=_drop_overrides),
    14: Misbehaviour("stays in the replay", takes=_stay_in_replay),
    15: Misbehaviour(
        "moves every altitude with the altimeter's setting",
        distorts={
            "sim/cockpit2/gauges/indicators/altitude_ft_pilot": _by_knob,
            "sim/flightmodel2/position/pressure_altitude": _by_knob,
        },
    ),
    16: Misbehaviour("hides that its autopilot is on", distorts={SERVOS_ON: lambda *_: 0.0}),
    17: Misbehaviour("runs four times as fast when asked for twice", takes=_run_too_fast),
    18: Misbehaviour(_DROPS, each_frame=_drop_overrides),
    19: Misbehaviour(
        "keeps the overrides",
        takes=_keep_overrides,
        each_frame=_set_overrides_again,
        keeps_overrides=True,
    ),
    20: Misbehaviour("keeps the overrides", takes=_keep_overrides, keeps_overrides=True),
}
"""By the number of the step."""
