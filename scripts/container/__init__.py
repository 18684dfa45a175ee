"""What a container starts, and how it answers health checks."""
