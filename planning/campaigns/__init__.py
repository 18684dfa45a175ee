"""Missions from several launch sites over several days: where crews launch, and when they drive."""
