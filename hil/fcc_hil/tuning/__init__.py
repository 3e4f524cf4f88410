"""Finds gains for an aircraft: parallel flights, a cost, and a configuration as the result.

`identify` measures the aircraft's response to its controls, `search` starts from there, `cost`
rates a flight.
"""

from .cost import COSTS, Cost, cost_of, flight_cost
from .search import SCALE_KEYS, Found, Task, tune

__all__ = ["COSTS", "SCALE_KEYS", "Cost", "Found", "Task", "cost_of", "flight_cost", "tune"]
