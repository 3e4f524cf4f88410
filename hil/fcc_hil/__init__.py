"""A JSBSim stand-in for X-Plane, and the flights that score `fccd` against it.

The package has its own implementation of X-Plane's UDP protocol, written from
the layouts and sharing nothing with the daemon's, so that the two ends check
each other:

- `plant` flies JSBSim in lockstep; `aircraft` says which aircraft and how fast;
- `protocol` and `datarefs` are X-Plane's side of the wire; `standin` serves them
  in real time, `process` runs that in a process of its own;
- `pattern` is the timed pattern, `score` measures a flight through it, `peer`
  flies it with JSBSim's own autopilot;
- `fly` puts the daemon, the stand-in and the score together.
"""
