"""The stand-in in a separate process, so that nothing else delays a frame.

    with StandInProcess(Settings(port=0)) as simulator:
        simulator.port                                # fly against it
        simulator.write("sim/cockpit2/switches/generic_lights_switch[56]", 1.0)
        simulator.act("freeze:1.5")                   # what a person or X-Plane itself does
        truth = simulator.truth()

Commands and answers go through a pipe that the stand-in polls once per frame.
"""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing.connection import Connection
from operator import attrgetter, methodcaller
from typing import Any, cast

from . import actions
from .board_link import Change
from .boarded import BoardedStandIn
from .cockpit import Release, Write
from .faulty_sensors import SensorFault
from .person import AttendedStandIn
from .standin import Mode, Progress, Settings, StandIn
from .truth import Row, Truth

_START_S = 30.0
_ANSWER_S = 10.0
_STOP_S = 5.0

# Above everything without a real-time priority, below any flight control computer.
_PRIORITY = 5


class StandInError(RuntimeError):
    """The stand-in's process could not be started, or has ended."""


Order = Callable[[StandIn], object]
"""What is to be done with the stand-in, in its own process: it is sent there, so not a lambda."""


def interrupt(*_: object) -> None:
    """End as with Ctrl-C: the handler of a signal that ends what this process has started, too."""
    raise KeyboardInterrupt


def request_real_time() -> str:
    """Request a real-time priority; return what was granted."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
    except OSError as error:
        return f"SCHED_OTHER (SCHED_FIFO denied: {error.strerror})"
    return f"SCHED_FIFO {_PRIORITY}"


def _simulator(settings: Settings) -> StandIn:
    if settings.board:
        return BoardedStandIn(settings)
    if settings.phone is not None:
        from .phoned import PhonedStandIn  # noqa: PLC0415 - needs the module fcc

        return PhonedStandIn(settings)
    return AttendedStandIn(settings) if settings.person else StandIn(settings)


def _serve(settings: Settings, pipe: Connection) -> None:
    # Ctrl-C reaches the whole group; the starting process ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        simulator = _simulator(settings)
    except Exception as error:
        pipe.send(error)
        return
    pipe.send((simulator.port, simulator.reply_port))
    simulator.scheduling = request_real_time()

    def each_frame() -> bool:
        try:
            while pipe.poll():
                order: Order | None = pipe.recv()
                if order is None:
                    return False
                try:
                    pipe.send(order(simulator))
                except (ValueError, RuntimeError) as error:
                    pipe.send(error)
        except (EOFError, OSError):
            return False
        return True

    # A garbage collection in flight would delay a frame, and there are no reference cycles to
    # collect.
    gc.freeze()
    gc.disable()
    simulator.run(each_frame)
    simulator.close()


def _truth(simulator: StandIn) -> Truth:
    return Truth(simulator.truth)


def _rows(simulator: StandIn, first: int) -> list[Row]:
    return simulator.truth[first:]


def _set_sensor_faults(simulator: StandIn, faults: Sequence[SensorFault]) -> None:
    simulator.sensors.set_faults(faults)


class StandInProcess:
    """A running stand-in; a context manager that stops it."""

    def __init__(self, settings: Settings) -> None:
        """Start it and wait until it listens. Raise StandInError if it cannot."""
        self.settings = settings
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=_serve, args=(settings, theirs), name="standin", daemon=True
        )
        self._process.start()
        theirs.close()
        try:
            ports = cast("tuple[int, int]", self._receive(_START_S))
        except StandInError:
            self.kill()
            raise
        self.port, self.reply_port = ports
        """The ports that it listens on and that it sends from."""

    def __enter__(self) -> StandInProcess:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def read(self, path: str) -> float | None:
        """Return a dataref as a client would read it now, without noise; None if unknown."""
        return cast("float | None", self._ask(methodcaller("read", path)))

    def write(self, path: str, value: float) -> float:
        """Set a dataref from inside the simulator; return the simulated time, s."""
        return cast(float, self._ask(methodcaller("write", path, value)))

    def progress(self) -> Progress:
        """Return the progress of the flight."""
        return cast(Progress, self._ask(methodcaller("progress")))

    def status(self) -> dict[str, Any]:
        """Return clients, received messages, refused datagrams and the statistics of frames."""
        return cast("dict[str, Any]", self._ask(methodcaller("status")))

    def truth(self) -> Truth:
        """Return the truth so far, 40 rows per second of simulated time."""
        return cast(Truth, self._ask(_truth))

    def rows(self, first: int) -> list[Row]:
        """Return the rows of the truth from number `first` on, as `truth.row` makes them."""
        return cast("list[Row]", self._ask(partial(_rows, first=first)))

    def set_sensor_faults(self, faults: Sequence[SensorFault]) -> None:
        """Replace the faults of the sensors."""
        self._ask(partial(_set_sensor_faults, faults=list(faults)))

    def journal(self) -> list[Write]:
        """Return every write to a dataref so far."""
        return cast("list[Write]", self._ask(attrgetter("cockpit.journal")))

    def releases(self) -> list[Release]:
        """Return every release of an override so far, with the controls at that time."""
        return cast("list[Release]", self._ask(attrgetter("cockpit.releases")))

    def set_mode(self, mode: Mode) -> None:
        """Pause, stall, freeze or run."""
        self._ask(methodcaller("enter", mode))

    def act(self, action: str) -> None:
        """Do what a person or the simulator does: `pause`, `freeze:1.5`, ... (see `actions`).

        Raise StandInError for what is no action.
        """
        self._ask(partial(actions.act, text=action))

    def board_port(self) -> int:
        """Return the servo board's UDP port."""
        return cast("int", self._ask(methodcaller("at_board", "port")))

    def board_changes(self) -> list[Change]:
        """Return every change of control of the servo board's so far."""
        return cast("list[Change]", self._ask(methodcaller("at_board", "changes")))

    def board_counts(self) -> dict[str, int]:
        """Return how many frames the servo board received, and were corrupt and lost."""
        return cast("dict[str, int]", self._ask(methodcaller("at_board", "counts")))

    def at_board(self, action: str, *arguments: float) -> None:
        """Pull out its cable, put it back, disturb it or reboot it (`RunningBoard`)."""
        self._ask(methodcaller("at_board", action, *arguments))

    def stop(self) -> None:
        """End it; does nothing if it has ended."""
        if self._process.is_alive():
            with contextlib.suppress(OSError):
                self._pipe.send(None)
            self._process.join(_STOP_S)
        self.kill()

    def kill(self) -> None:
        """Kill it, as a crash does: its clients receive nothing."""
        if self._process.is_alive():
            self._process.kill()
        self._process.join(_STOP_S)
        self._pipe.close()

    def _ask(self, order: Order) -> object:
        try:
            self._pipe.send(order)
        except OSError as error:
            raise StandInError("the stand-in's process has ended") from error
        return self._receive(_ANSWER_S)

    def _receive(self, timeout_s: float) -> object:
        try:
            if not self._pipe.poll(timeout_s):
                raise StandInError(f"the stand-in has not answered for {timeout_s:.0f} s")
            answer = self._pipe.recv()
        except (EOFError, OSError) as error:
            raise StandInError("the stand-in's process has ended") from error
        if isinstance(answer, Exception):
            raise StandInError(str(answer)) from answer
        return cast(object, answer)
