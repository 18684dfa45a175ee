"""What programs tell of themselves."""
