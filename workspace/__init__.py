"""Organisations, jobs, history, live pages, and what the endpoints of the API share."""

from workspace import reasons as reasons
