"""From a file that came in to a change of the ground: read it, show what it would change, apply it or throw it away."""
