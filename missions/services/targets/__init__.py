"""Targets of a request as places and visits, and the reasons why one is left out or a route is as it is."""
