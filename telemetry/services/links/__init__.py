"""Links to vehicles: leases, received data, and waiting commands."""
