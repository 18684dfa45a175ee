"""The MAVLink gateway, the process that vehicles connect to. Any gateway serves any UAV; lasting state is in PostgreSQL."""
