"""Report of a flown mission: flown against planned, and the outcome of each target."""
