"""MAVLink without a vehicle: frames in and out, and missions as items. Pure."""
