"""Orders to a vehicle, from the choice of commands to the effect that the vehicle reports. Pure."""
