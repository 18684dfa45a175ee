"""A UAV that is not there: it flies the very mission in JSBSim, and speaks MAVLink like any other."""

from simulation import reasons as reasons
