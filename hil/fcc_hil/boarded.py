"""A stand-in whose surfaces are driven by a servo board, and by nothing else.

The aircraft's pitot tube and the engage switch are the board's; the simulator's own protocol gives
the other readings, as the computer's own sensors would.
"""

from __future__ import annotations

from pathlib import Path

from .board_link import RunningBoard
from .cockpit import ENGAGE_SWITCH
from .servo_board import Readings
from .settings import Settings
from .standin import StandIn
from .units import impact_pressure_pa


class BoardedStandIn(StandIn):
    """A stand-in with a servo board."""

    def __init__(self, settings: Settings) -> None:
        """Set both up; raise OSError if a port or a terminal cannot be opened."""
        super().__init__(settings)
        link = None if settings.board == "udp" else Path(settings.board)
        self.board = RunningBoard(link, seed=settings.seed)
        self._pilot = self.cockpit.pilot

    def close(self) -> None:
        """Close the ports, and end the board."""
        self.board.close()
        super().close()

    def fly(self) -> None:
        """Fly a frame with the surfaces where the board has them."""
        state = self.plant.state()
        self.board.readings = Readings(
            airspeed_mps=state.airspeed_mps,
            differential_pressure_pa=impact_pressure_pa(state.airspeed_mps),
            engage_switch=(self.read(ENGAGE_SWITCH) or 0.0) >= 0.5,
            pilot=self._pilot,
        )
        self.cockpit.hold(self.board.drive(self._pilot))
        super().fly()

    def at_board(self, action: str, *arguments: float) -> object:
        """Do something at the board, or return what it has to show."""
        board = self.board
        if action == "port":
            return board.port
        if action == "changes":
            return board.changes
        if action == "counts":
            return board.counts()
        actions = {"pull": board.pull, "put_back": board.put_back, "reboot": board.reboot}
        if action == "disturb":
            board.disturb(*arguments)
        else:
            actions[action]()
        return None
