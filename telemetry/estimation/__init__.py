"""Where a UAV is between two reports, and how sure we are."""
