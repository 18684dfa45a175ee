"""The final checks of a plan: zones, obstacles, lost link and return to launch."""
