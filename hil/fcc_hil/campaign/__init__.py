"""The campaign: Monte Carlo flights at the edges of the envelope, judged by the true state.

`aircraft` says where each aircraft stalls, `draw` draws the conditions of a flight, `air` moves the
air, `flying` flies one, `verdict` judges it, `report` and `picture` show all of them.
"""
