"""Reads of media and findings."""
