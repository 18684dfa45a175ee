"""Camera views of infrastructure: poses, coverage and clearance."""
