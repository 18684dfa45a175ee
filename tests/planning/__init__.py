"""Tests of waypoints, heights, times and the last look at the zones."""
