"""Terrain files as rasters of heights."""
