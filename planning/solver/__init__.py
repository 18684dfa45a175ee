"""Assignment and order: which UAV inspects which target in which order."""
