"""Finds gains for an aircraft: parallel flights, a cost, and a configuration as the result.

`identify` measures the aircraft's response to its controls, `search` starts from there, `cost`
rates a flight, `workers` fly.
"""

from .cost import COSTS, Cost, cost_of
from .search import SCALE_KEYS, Found, Task, tune
from .workers import local_workers, on_dask

__all__ = [
    "COSTS",
    "SCALE_KEYS",
    "Cost",
    "Found",
    "Task",
    "cost_of",
    "local_workers",
    "on_dask",
    "tune",
]
