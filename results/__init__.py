"""What inspections found: media, what they show, and findings."""

from results import reasons as reasons
