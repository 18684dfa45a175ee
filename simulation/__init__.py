"""Simulated UAVs: they fly missions in JSBSim and use MAVLink like real UAVs."""

from simulation import reasons as reasons
