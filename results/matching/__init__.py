"""Places photos at the targets of a mission."""
