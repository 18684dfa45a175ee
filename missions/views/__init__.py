"""The API's doors to planning, missions and UAVs."""

from missions.views.missions import MissionDetail, MissionHistory, MissionList, MissionPlan, MissionRestore
from missions.views.plans import PlanList
from missions.views.uavs import UavDetail, UavList

__all__ = ["MissionDetail", "MissionHistory", "MissionList", "MissionPlan", "MissionRestore", "PlanList", "UavDetail", "UavList"]
