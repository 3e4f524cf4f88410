"""The flight suite: many aircraft, conditions and initial states, each checked against limits.

`matrix` defines the flights, `limits` and `limit_table` the limits, `flying` flies them in parallel
processes, `report` and `picture` show the results.
"""

from .flying import Outcome, fly_all, fly_case
from .matrix import Case, cases

__all__ = ["Case", "Outcome", "cases", "fly_all", "fly_case"]
