"""The inspection graph: how infrastructure connects, clear of no-fly zones."""
