"""Reads of missions, fleet, flights and commands, always within one organisation."""
