"""The estimator: a process that estimates every UAV on a mission once a second."""
