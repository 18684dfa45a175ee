"""The MAVLink gateway: a process that vehicles talk to. Any of several serves any UAV; what must last is in PostgreSQL."""
