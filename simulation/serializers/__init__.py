"""Rehearsals and simulations in the API."""
