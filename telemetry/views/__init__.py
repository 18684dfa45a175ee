"""API views of the UAV link, the log, alerts and unknown vehicles."""
