"""From a route to waypoints with heights, checked leg by leg."""
