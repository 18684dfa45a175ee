"""Flown tracks as files."""
