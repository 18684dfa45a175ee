"""One command to a vehicle, from its choice to the effect that the vehicle reports. Pure."""
