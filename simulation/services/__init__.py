"""Writes of simulation: rehearsals from request to verdict, airframes of types, and the rule of approvals."""
