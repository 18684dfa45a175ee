"""Endpoints of media and findings."""
