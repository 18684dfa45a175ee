"""Flown against planned, and what came of it."""
