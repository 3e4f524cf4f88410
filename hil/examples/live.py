"""Watch a flight of fccd from Python: `python live.py [INSTANCE]`.

Needs `pip install iceoryx2` and a daemon that flies on this machine, for example
`fccd fly`. The layouts are those of docs/telemetry.md; copy what you need.
"""

from __future__ import annotations

import ctypes
import math
import os
import sys
import time
from collections.abc import Iterator
from typing import Any

import iceoryx2 as iox2

LAYOUT = 2
"""The layout that this program was written for."""
NEVER_NS = -(2**63)
"""The time of something that never happened."""

STATES = ("standby", "engaged", "failsafe", "stopped")


class LiveError(RuntimeError):
    """Nothing can be watched, or its layout is not supported."""


def reading(value: Any) -> Any:
    """Return the layout of a value and the time at which it was taken."""

    class Reading(ctypes.Structure):
        _fields_ = (
            ("value", value),
            ("taken_ns", ctypes.c_int64),
            ("source", ctypes.c_uint8),
        )

    return Reading


class Tick(ctypes.Structure):
    """A tick and its times."""

    _fields_ = (
        ("number", ctypes.c_uint64),
        ("scheduled_ns", ctypes.c_int64),
        ("woke_ns", ctypes.c_int64),
        ("missed", ctypes.c_uint64),
        ("dt_s", ctypes.c_double),
    )


class Stages(ctypes.Structure):
    """Durations of a tick's stages."""

    _fields_ = (
        ("sensors_ns", ctypes.c_uint64),
        ("estimate_ns", ctypes.c_uint64),
        ("guide_ns", ctypes.c_uint64),
        ("control_ns", ctypes.c_uint64),
        ("actuators_ns", ctypes.c_uint64),
        ("total_ns", ctypes.c_uint64),
    )


class Attitude(ctypes.Structure):
    """Pitch and roll."""

    _fields_ = (("pitch_rad", ctypes.c_double), ("roll_rad", ctypes.c_double))


class BodyRates(ctypes.Structure):
    """Turn rates about the body axes."""

    _fields_ = (
        ("roll_radps", ctypes.c_double),
        ("pitch_radps", ctypes.c_double),
        ("yaw_radps", ctypes.c_double),
    )


class SpecificForce(ctypes.Structure):
    """Specific force."""

    _fields_ = (
        ("x_mps2", ctypes.c_double),
        ("y_mps2", ctypes.c_double),
        ("z_mps2", ctypes.c_double),
    )


class Position(ctypes.Structure):
    """A place on the WGS 84 ellipsoid."""

    _fields_ = (
        ("latitude_rad", ctypes.c_double),
        ("longitude_rad", ctypes.c_double),
        ("altitude_m", ctypes.c_double),
    )


class Velocity(ctypes.Structure):
    """Velocity over the ground."""

    _fields_ = (
        ("north_mps", ctypes.c_double),
        ("east_mps", ctypes.c_double),
        ("down_mps", ctypes.c_double),
    )


class Surfaces(ctypes.Structure):
    """Throttle and control surfaces."""

    _fields_ = (
        ("throttle", ctypes.c_double),
        ("elevator", ctypes.c_double),
        ("aileron", ctypes.c_double),
        ("rudder", ctypes.c_double),
    )


class Plant(ctypes.Structure):
    """A simulated plant's time and state."""

    _fields_ = (("time_s", ctypes.c_double), ("state", ctypes.c_uint8))


class Measurements(ctypes.Structure):
    """Measurements of the sensors."""

    _fields_ = (
        ("attitude", reading(Attitude)),
        ("heading_rad", reading(ctypes.c_double)),
        ("body_rates", reading(BodyRates)),
        ("specific_force", reading(SpecificForce)),
        ("airspeed_mps", reading(ctypes.c_double)),
        ("altitude_m", reading(ctypes.c_double)),
        ("angle_of_attack_rad", reading(ctypes.c_double)),
        ("position", reading(Position)),
        ("velocity", reading(Velocity)),
        ("surfaces", reading(Surfaces)),
        ("engage_switch", reading(ctypes.c_uint8)),
        ("plant", reading(Plant)),
    )


class Estimate(ctypes.Structure):
    """Navigation's estimate."""

    _fields_ = (
        ("roll_rad", ctypes.c_double),
        ("pitch_rad", ctypes.c_double),
        ("heading_rad", ctypes.c_double),
        ("body_rates", BodyRates),
        ("airspeed_mps", ctypes.c_double),
        ("true_airspeed_mps", ctypes.c_double),
        ("altitude_m", ctypes.c_double),
        ("climb_rate_mps", ctypes.c_double),
        ("side_force_mps2", ctypes.c_double),
    )


class Targets(ctypes.Structure):
    """Targets of guidance."""

    _fields_ = (
        ("airspeed_mps", ctypes.c_double),
        ("heading_rad", ctypes.c_double),
        ("altitude_m", ctypes.c_double),
    )


class Progress(ctypes.Structure):
    """The active mode of guidance and its progress."""

    _fields_ = (
        ("mode", ctypes.c_uint8),
        ("item", ctypes.c_uint32),
        ("elapsed_s", ctypes.c_double),
        ("captured", Targets),
    )


class Setpoints(ctypes.Structure):
    """Set points of the autopilot."""

    _fields_ = (
        ("airspeed_mps", ctypes.c_double),
        ("heading_rad", ctypes.c_double),
        ("altitude_m", ctypes.c_double),
        ("roll_rad", ctypes.c_double),
        ("climb_rate_mps", ctypes.c_double),
        ("pitch_rad", ctypes.c_double),
        ("guidance", Progress),
    )


class State(ctypes.Structure):
    """The loop's state: `STATES[phase]`."""

    _fields_ = (
        ("phase", ctypes.c_uint8),
        ("cause", ctypes.c_uint8),
        ("flags", ctypes.c_uint32),
    )


class Record(ctypes.Structure):
    """The record of one tick."""

    _fields_ = (
        ("tick", Tick),
        ("stages", Stages),
        ("measurements", Measurements),
        ("estimate", Estimate),
        ("setpoints", Setpoints),
        ("outputs", Surfaces),
        ("sensor_faults", ctypes.c_uint64),
        ("actuator_faults", ctypes.c_uint64),
        ("records_dropped", ctypes.c_uint64),
        ("overruns", ctypes.c_uint64),
        ("page_faults", ctypes.c_uint64),
        ("early_wake_ns", ctypes.c_uint64),
        ("state", State),
        ("engage_inhibits", ctypes.c_uint32),
        ("faults", ctypes.c_uint32),
        ("sent", ctypes.c_uint8),
    )

    @staticmethod
    def type_name() -> str:
        """Return the daemon's name of this type."""
        return "fcc.v2.Record"


class Event(ctypes.Structure):
    """An event."""

    _fields_ = (
        ("tick", ctypes.c_uint64),
        ("time_ns", ctypes.c_int64),
        ("code", ctypes.c_uint32),
        ("index", ctypes.c_uint32),
        ("values", ctypes.c_uint64 * 3),
        ("text", ctypes.c_char * 208),
    )

    @staticmethod
    def type_name() -> str:
        """Return the daemon's name of this type."""
        return "fcc.v2.Event"


class Info(ctypes.Structure):
    """The daemon and its layouts."""

    _fields_ = (
        ("layout", ctypes.c_uint32),
        ("record_bytes", ctypes.c_uint32),
        ("event_bytes", ctypes.c_uint32),
        ("status_bytes", ctypes.c_uint32),
        ("process_id", ctypes.c_uint32),
        ("priority", ctypes.c_int32),
        ("memory_locked", ctypes.c_uint32),
        ("requests_denied", ctypes.c_uint32),
        ("started_unix_ns", ctypes.c_int64),
        ("started_ns", ctypes.c_int64),
        ("rate_hz", ctypes.c_double),
        ("software", ctypes.c_char * 32),
        ("commit", ctypes.c_char * 48),
        ("timer", ctypes.c_char * 16),
        ("policy", ctypes.c_char * 16),
        ("aircraft", ctypes.c_char * 64),
        ("refusals", ctypes.c_char * 280),
    )

    @staticmethod
    def type_name() -> str:
        """Return the daemon's name of this type."""
        return "fcc.Info"


class Watcher:
    """Watches a daemon on this machine."""

    def __init__(self, instance: str = "fccd", patience_s: float = 1.0) -> None:
        """Connect to the daemon; refuse one with another layout."""
        iox2.set_log_level(iox2.LogLevel.Error)
        config = iox2.config.default()
        # Each user has a folder: only the daemon's own user can watch it.
        config.global_cfg.root_path = iox2.Path.new(f"/dev/shm/fccd-{os.geteuid()}")
        config.global_cfg.prefix = iox2.FileName.new(f"fccd-{os.geteuid()}_")
        self._node = (
            iox2.NodeBuilder.new()
            .config(config)
            .signal_handling_mode(iox2.SignalHandlingMode.Disabled)
            .create(iox2.ServiceType.Ipc)
        )
        infos = self._subscribe(f"fcc/{instance}/info", Info, instance)
        deadline_s = time.monotonic() + patience_s
        while not (told := list(_received(infos))):
            if time.monotonic() > deadline_s:
                raise LiveError(f"no fccd named '{instance}' runs here any more")
            time.sleep(0.01)
        self.info: Info = told[-1]
        if (self.info.layout, self.info.record_bytes) != (LAYOUT, ctypes.sizeof(Record)):
            raise LiveError(
                f"fccd '{instance}' publishes in layout {self.info.layout}, and this program "
                f"reads layout {LAYOUT}: see docs/telemetry.md of the daemon's version"
            )
        self._records = self._subscribe(f"fcc/{instance}/record/v{LAYOUT}", Record, instance)
        self._events = self._subscribe(f"fcc/{instance}/event/v{LAYOUT}", Event, instance)

    def records(self) -> Iterator[Record]:
        """Yield the records received since the last call, oldest first."""
        return _received(self._records)

    def events(self) -> Iterator[Event]:
        """Yield the events received since the last call, oldest first."""
        return _received(self._events)

    def _subscribe(self, name: str, payload: Any, instance: str) -> Any:
        try:
            builder = self._node.service_builder(iox2.ServiceName.new(name))
            return builder.publish_subscribe(payload).open().subscriber_builder().create()
        except iox2.PublishSubscribeOpenError as error:
            raise LiveError(
                f"no fccd named '{instance}' runs here, or it is not yours: start one, for "
                f"example with `fccd fly --instance {instance}` ({error})"
            ) from None


def _received(subscriber: Any) -> Iterator[Any]:
    while (sample := subscriber.receive()) is not None:
        payload = sample.payload().contents
        # A copy: the sample returns to the daemon when it is dropped.
        yield type(payload).from_buffer_copy(payload)


def main() -> None:
    """Print a line four times a second until the daemon stops publishing."""
    watcher = Watcher(sys.argv[1] if len(sys.argv) > 1 else "fccd")
    info = watcher.info
    print(f"{info.aircraft.decode()}: {info.rate_hz} Hz by {info.timer.decode()}")
    silent_since_s = time.monotonic()
    while time.monotonic() - silent_since_s < 2.0:
        for event in watcher.events():
            print(f"tick {event.tick}: {event.text.decode()}")
        for record in list(watcher.records())[-1:]:
            silent_since_s = time.monotonic()
            measured = record.measurements
            late_us = (record.tick.woke_ns - record.tick.scheduled_ns) / 1e3
            print(
                f"tick {record.tick.number}: {STATES[record.state.phase]}, "
                f"heading {math.degrees(measured.heading_rad.value):.1f} deg, "
                f"altitude {measured.altitude_m.value:.1f} m, "
                f"airspeed {measured.airspeed_mps.value:.1f} m/s, {late_us:.1f} us late"
            )
        time.sleep(0.25)


if __name__ == "__main__":
    try:
        main()
    except LiveError as error:
        sys.exit(f"live: {error}")
    except KeyboardInterrupt:
        pass
