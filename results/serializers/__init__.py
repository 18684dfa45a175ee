"""Shapes of media and findings in the API."""
