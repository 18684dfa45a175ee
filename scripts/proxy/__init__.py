"""The reverse proxy: its configuration, limits, page headers and certificates."""
