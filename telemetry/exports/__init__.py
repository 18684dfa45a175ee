"""Flown tracks as files: records in, pieces of text out, so that a file of any length takes no memory. Pure."""
