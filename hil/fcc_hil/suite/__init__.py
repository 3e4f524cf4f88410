"""The flight suite: many aircraft, weathers and beginnings, each held to stated limits.

`matrix` says what is flown, `limits` what is asked of it, `flying` flies it in parallel
processes, `report` and `picture` show it.
"""

from .flying import Outcome, fly_all, fly_case
from .matrix import Case, cases

__all__ = ["Case", "Outcome", "cases", "fly_all", "fly_case"]
