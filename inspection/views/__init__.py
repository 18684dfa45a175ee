"""API endpoints of map data."""
