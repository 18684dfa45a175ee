"""Checks of returns and landings from the present position, and returns that are safe."""
