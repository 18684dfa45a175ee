"""Who works here: organisations, jobs, history, live pages, and what the API has in common."""

from workspace import reasons as reasons
