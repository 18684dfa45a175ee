"""Which assets can be inspected from where UAVs stand."""
