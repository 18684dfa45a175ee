"""Missions, their plans and approvals, the fleet, and commands to UAVs."""

from missions import reasons as reasons
