"""Reads of the log, links, alerts and reports."""
