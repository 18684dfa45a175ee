"""Detectors: one cause each, with its delays."""
