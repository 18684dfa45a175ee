"""Start commands and health checks of containers."""
