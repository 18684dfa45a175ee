"""Decodes MAVLink messages to the log's fields, with their time of measurement. Pure."""
