"""Rehearsals in the shapes of the API."""
