"""The simulator: a process that flies leased simulations in real time."""
