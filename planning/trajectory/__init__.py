"""From routes to waypoints with heights, speeds and times."""
