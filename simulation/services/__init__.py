"""Services of simulation: rehearsals, airframes of types, approval rules, and simulated flights."""
