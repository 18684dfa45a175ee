"""From a plan request to a plan: map data, candidate plans, trajectories and the final check."""
