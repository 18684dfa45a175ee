"""Positions and measures on the WGS84 ellipsoid."""

from inspection.geodesy.wgs84 import LonLat, distance_m, path_length_m

__all__ = ["LonLat", "distance_m", "path_length_m"]
