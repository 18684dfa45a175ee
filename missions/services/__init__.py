"""Writes of missions, and planning: from a request to a plan, from a plan to stored routes."""

from missions.services.planning import GraphOutdated, make_plan
from missions.services.requests import InvalidRequest, PlanRequest, TargetRequest, UavRequest, request_from_json, request_to_json

__all__ = [
    "GraphOutdated",
    "InvalidRequest",
    "PlanRequest",
    "TargetRequest",
    "UavRequest",
    "make_plan",
    "request_from_json",
    "request_to_json",
]
