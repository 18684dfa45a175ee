"""Reads photos of UAV cameras: position, heights, attitude and time as one record for all makers, and derivatives for pages."""
