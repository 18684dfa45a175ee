"""Reads of the ground: what views, commands and the other apps call."""
