"""Find gains for an aircraft: flights in parallel, a stated cost, a configuration at the end.

`identify` measures how strongly the aircraft answers its controls, `search` begins there
and looks around, `cost` says what a flight is worth, `workers` fly.
"""

from .cost import COSTS, Cost, cost_of
from .search import SCALE_KEYS, Found, Order, tune
from .workers import local_workers, on_dask

__all__ = [
    "COSTS",
    "SCALE_KEYS",
    "Cost",
    "Found",
    "Order",
    "cost_of",
    "local_workers",
    "on_dask",
    "tune",
]
