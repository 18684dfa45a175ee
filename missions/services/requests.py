"""What is asked of the planner, as plain values; stored as JSON while a job waits."""

from dataclasses import dataclass
from typing import Any

from inspection.geodesy import LonLat
from missions.models import EndAction
from missions.routing.problem import Objective, Task, TaskKind


@dataclass(frozen=True)
class UavRequest:
    name: str
    position: LonLat
    max_range_m: float | None
    cruise_speed_mps: float
    end_action: EndAction
    uav: int | None = None  # primary key of a stored UAV


@dataclass(frozen=True)
class TargetRequest:
    """An asset, a point or stretch on one, or a bare position. Neither asset nor position: the asset has been deleted."""

    asset: int | None = None
    position: LonLat | None = None
    stretch: tuple[LonLat, LonLat] | None = None
    task: Task | None = None


@dataclass(frozen=True)
class PlanRequest:
    uavs: tuple[UavRequest, ...]
    targets: tuple[TargetRequest, ...]
    objective: Objective
    return_to_start: bool


class InvalidRequest(Exception):
    """The request cannot be planned as it stands; faults by place: {"targets.0.position": "…"}."""

    def __init__(self, faults: dict[str, str]) -> None:
        super().__init__("; ".join(f"{place}: {fault}" for place, fault in faults.items()))
        self.faults = faults


def task_to_json(task: Task) -> dict[str, Any]:
    return {"kind": task.kind.value, "hold_s": task.hold_s}


def task_from_json(value: dict[str, Any] | None) -> Task | None:
    return Task(TaskKind(value["kind"]), float(value["hold_s"])) if value else None


def request_to_json(request: PlanRequest) -> dict[str, Any]:
    return {
        "uavs": [
            {
                "name": uav.name,
                "position": list(uav.position),
                "max_range_m": uav.max_range_m,
                "cruise_speed_mps": uav.cruise_speed_mps,
                "end_action": uav.end_action.value,
                "uav": uav.uav,
            }
            for uav in request.uavs
        ],
        "targets": [
            {
                "asset": target.asset,
                "position": list(target.position) if target.position else None,
                "stretch": [list(end) for end in target.stretch] if target.stretch else None,
                "task": task_to_json(target.task) if target.task else None,
            }
            for target in request.targets
        ],
        "objective": request.objective.value,
        "return_to_start": request.return_to_start,
    }


def request_from_json(value: dict[str, Any]) -> PlanRequest:
    return PlanRequest(
        uavs=tuple(
            UavRequest(
                name=uav["name"],
                position=LonLat(*uav["position"]),
                max_range_m=uav["max_range_m"],
                cruise_speed_mps=uav["cruise_speed_mps"],
                end_action=EndAction(uav["end_action"]),
                uav=uav["uav"],
            )
            for uav in value["uavs"]
        ),
        targets=tuple(
            TargetRequest(
                asset=target["asset"],
                position=LonLat(*target["position"]) if target["position"] else None,
                stretch=(LonLat(*target["stretch"][0]), LonLat(*target["stretch"][1])) if target["stretch"] else None,
                task=task_from_json(target["task"]),
            )
            for target in value["targets"]
        ),
        objective=Objective(value["objective"]),
        return_to_start=value["return_to_start"],
    )
