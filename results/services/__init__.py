"""What writes media and findings."""
