"""The campaign: Monte Carlo flights of three kinds, judged by the true state.

`aircraft` says where each aircraft stalls, `draw` draws the conditions of a flight, `air` moves the
air, `faults` puts in what fails, `flying` flies one, `alarms` finds what was excluded, `verdict`
judges it, `airspeed` measures a failed airspeed, `report` and `picture` show all of them.
"""
