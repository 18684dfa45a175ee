"""Files as infrastructure, zones and terrain: uploaded, compared, applied, and fetched again."""
