"""Which UAV inspects which target in which order."""
