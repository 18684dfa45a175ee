"""Writes of missions, and planning: from a request to a plan, from a plan to stored routes."""

from missions.services.mission_plans import NothingToPlan, plan_mission, plan_mission_for_job, plannable_request, store_plan
from missions.services.missions import (
    MissionChange,
    MissionChanged,
    MissionFrozen,
    change_mission,
    create_mission,
    delete_mission,
    request_of_mission,
    restore_mission,
)
from missions.services.places import places_of
from missions.services.plan_json import FLAT_GROUND, TERRAIN_MODEL
from missions.services.planning import GraphOutdated, make_plan
from missions.services.requests import InvalidRequest, PlanRequest, TargetRequest, UavRequest, request_from_json, request_to_json
from missions.services.uavs import NameTaken, UavInUse, change_uav, create_uav, delete_uav

__all__ = [
    "FLAT_GROUND",
    "TERRAIN_MODEL",
    "GraphOutdated",
    "InvalidRequest",
    "MissionChange",
    "MissionChanged",
    "MissionFrozen",
    "NameTaken",
    "NothingToPlan",
    "PlanRequest",
    "TargetRequest",
    "UavInUse",
    "UavRequest",
    "change_mission",
    "change_uav",
    "create_mission",
    "create_uav",
    "delete_mission",
    "delete_uav",
    "make_plan",
    "places_of",
    "plan_mission",
    "plan_mission_for_job",
    "plannable_request",
    "request_from_json",
    "request_of_mission",
    "request_to_json",
    "restore_mission",
    "store_plan",
]
