"""Alerts for operators: an ordered list of detectors, one module each."""
