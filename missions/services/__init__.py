"""Writes of missions, and planning: from a request to a plan, from a plan to stored routes."""

from missions.selectors.planning_context import with_bases
from missions.selectors.resolved_targets import resolved_targets
from missions.services.fleet.credentials import make_credential, mavlink_signing_key, revoke_credential
from missions.services.fleet.rows import (
    FleetChanged,
    FleetNameTaken,
    FleetRowInUse,
    NotDeleted,
    SystemIdQuota,
    SystemIdTaken,
    UavExternalIdTaken,
)
from missions.services.fleet.types_and_bases import (
    change_base,
    change_uav_type,
    create_base,
    create_uav_type,
    delete_base,
    delete_uav_type,
    restore_base,
    restore_uav_type,
)
from missions.services.fleet.uavs import change_uav, create_uav, delete_uav, restore_uav
from missions.services.manual_edits.checks import check_manual_edit
from missions.services.manual_edits.edits import change_route, take_back_change
from missions.services.manual_edits.points import EditedPoint
from missions.services.mission_copies import duplicate_mission
from missions.services.mission_plans import NothingToPlan, plan_mission, plan_mission_for_job, plannable_request, store_plan, take_plan
from missions.services.missions import (
    Charging,
    Departure,
    MissionChange,
    MissionChanged,
    MissionFrozen,
    change_mission,
    create_mission,
    delete_mission,
    request_of_mission,
    restore_mission,
)
from missions.services.plan_proofs import NothingToProve, begin_proof
from missions.services.planning.explanations import explain_route, explain_unreached_target
from missions.services.planning.planner import GraphOutdated, make_plan, warm_up
from planning.assignment.options import refuse_contradictions
from planning.plan_json import FLAT_GROUND, NO_QUALITY, NO_SHORTFALL, TERRAIN_MODEL, locked_targets
from planning.request import (
    CALM,
    BaseRequest,
    InvalidRequest,
    LockRequest,
    PlanRequest,
    TargetRequest,
    UavRequest,
    lock_to_json,
    priority_from_json,
    request_from_json,
    request_to_json,
)

__all__ = [
    "CALM",
    "FLAT_GROUND",
    "NO_QUALITY",
    "NO_SHORTFALL",
    "TERRAIN_MODEL",
    "BaseRequest",
    "Charging",
    "Departure",
    "EditedPoint",
    "FleetChanged",
    "FleetNameTaken",
    "FleetRowInUse",
    "GraphOutdated",
    "InvalidRequest",
    "LockRequest",
    "MissionChange",
    "MissionChanged",
    "MissionFrozen",
    "NotDeleted",
    "NothingToPlan",
    "NothingToProve",
    "PlanRequest",
    "SystemIdQuota",
    "SystemIdTaken",
    "TargetRequest",
    "UavExternalIdTaken",
    "UavRequest",
    "begin_proof",
    "change_base",
    "change_mission",
    "change_route",
    "change_uav",
    "change_uav_type",
    "check_manual_edit",
    "create_base",
    "create_mission",
    "create_uav",
    "create_uav_type",
    "delete_base",
    "delete_mission",
    "delete_uav",
    "delete_uav_type",
    "duplicate_mission",
    "explain_route",
    "explain_unreached_target",
    "lock_to_json",
    "locked_targets",
    "make_credential",
    "make_plan",
    "mavlink_signing_key",
    "plan_mission",
    "plan_mission_for_job",
    "plannable_request",
    "priority_from_json",
    "refuse_contradictions",
    "request_from_json",
    "request_of_mission",
    "request_to_json",
    "resolved_targets",
    "restore_base",
    "restore_mission",
    "restore_uav",
    "restore_uav_type",
    "revoke_credential",
    "store_plan",
    "take_back_change",
    "take_plan",
    "warm_up",
    "with_bases",
]
