"""A JSBSim stand-in for X-Plane, and the flights that score `fccd` against it.

The package has its own implementation of X-Plane's UDP protocol, written from the layouts and
independent of the daemon's, so that the two check each other:

- `plant` flies JSBSim in lockstep; `aircraft` says which aircraft and how fast;
- `protocol` and `datarefs` are X-Plane's side of the wire; `standin` serves them
  in real time, `process` runs that in a process of its own;
- `pattern` is the timed pattern, `score` measures a flight through it, `peer`
  flies it with JSBSim's own autopilot;
- `fly` puts the daemon, the stand-in and the score together.
- `pytest_plugin` makes a test of a flight: `flight` holds it against requirements on
  what was flown, by `quantities`, with `sensor_faults`, on one of the rigs
  (`lockstep_rig`, `daemon_rig`, `remote_rig`).
"""

from .quantities import (
    aileron,
    airspeed,
    altitude,
    attitude,
    bank,
    battery,
    body_rates,
    climb,
    elevator,
    engine_speed,
    heading,
    lateral,
    pitch,
    pitch_rate,
    position,
    roll_rate,
    rudder,
    specific_force,
    throttle,
    velocity,
    weight_on_wheels,
    yaw_rate,
)

__all__ = [
    "aileron",
    "airspeed",
    "altitude",
    "attitude",
    "bank",
    "battery",
    "body_rates",
    "climb",
    "elevator",
    "engine_speed",
    "heading",
    "lateral",
    "pitch",
    "pitch_rate",
    "position",
    "roll_rate",
    "rudder",
    "specific_force",
    "throttle",
    "velocity",
    "weight_on_wheels",
    "yaw_rate",
]
