"""The ground side of MAVLink's services, as state machines that know no socket, no database and no clock. Pure."""
