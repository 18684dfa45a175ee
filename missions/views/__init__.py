"""API endpoints of planning, missions and UAVs."""

from missions.views.credentials import UavCredentialDetail, UavCredentials
from missions.views.fleet import BaseDetail, BaseList, BaseRestore, UavTypeDetail, UavTypeList, UavTypeRestore
from missions.views.mission_sets import (
    MissionDuplicate,
    MissionFilterChoices,
    MissionFollowUp,
    MissionPresence,
    MissionsDelete,
    MissionsRestore,
)
from missions.views.missions import MissionDetail, MissionHistory, MissionList, MissionPlan, MissionProof, MissionRestore
from missions.views.plans import PlanList
from missions.views.uavs import UavDetail, UavList, UavMissions, UavRestore

__all__ = [
    "BaseDetail",
    "BaseList",
    "BaseRestore",
    "MissionDetail",
    "MissionDuplicate",
    "MissionFilterChoices",
    "MissionFollowUp",
    "MissionHistory",
    "MissionList",
    "MissionPlan",
    "MissionPresence",
    "MissionProof",
    "MissionRestore",
    "MissionsDelete",
    "MissionsRestore",
    "PlanList",
    "UavCredentialDetail",
    "UavCredentials",
    "UavDetail",
    "UavList",
    "UavMissions",
    "UavRestore",
    "UavTypeDetail",
    "UavTypeList",
    "UavTypeRestore",
]
