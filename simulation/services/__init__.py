"""Writes of simulation: rehearsals from request to assessment, airframes of types, and the rule of approvals."""
