"""The registers of assets and zones: filters, orders and counts."""
