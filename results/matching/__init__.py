"""Matches photos with captures and targets."""
