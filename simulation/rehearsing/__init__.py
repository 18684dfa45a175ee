"""Flying all routes of a mission at full speed: under which conditions, by which airframes, in lock-step of time."""
