"""The UAV link, the log, and vehicles that nobody knows, over HTTP."""
