"""Assets and zones as files."""
