"""What is to be flown: missions, their plans and approvals, the fleet, and commands to UAVs."""

from missions import reasons as reasons
