"""Time, power and battery of flights, along legs, paths and whole routes."""
