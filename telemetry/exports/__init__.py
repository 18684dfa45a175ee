"""Exports of flown tracks. They are generators of text, so that a file of any length needs no memory. Pure."""
