"""What is asked of the planner, as plain values; stored as JSON while a job waits."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from enum import StrEnum
from typing import Any

from inspection.geodesy import LonLat
from operation.reasons import Reason
from planning.clearance.lost_link import LostLink
from planning.energy.conditions import Conditions, conditions_from_json, conditions_to_json
from planning.energy.performance import Performance, performance_from_json, performance_to_json
from planning.problem import End, Objective, Priority
from planning.task import Task, task_from_json, task_to_json


class EndAction(StrEnum):
    """What a UAV does after its last target."""

    HOVER = "hover"
    RETURN = "return"
    LAND = "land"
    BASE = "base"


ROUTE_ENDS = {EndAction.HOVER: End.OPEN, EndAction.LAND: End.OPEN, EndAction.RETURN: End.RETURN, EndAction.BASE: End.ANY_BASE}
NO_BATTERY = Performance()  # whose energy is not counted
CALM = Conditions()


@dataclass(frozen=True)
class UavRequest:
    name: str
    position: LonLat
    max_range_m: float | None
    cruise_speed_mps: float
    end_action: EndAction
    uav: int | None = None  # primary key of a stored UAV
    most_targets: int | None = None
    sensors: tuple[str, ...] = ()
    performance: Performance = NO_BATTERY
    sorties: int = 1  # flights that it makes at most; several only where it returns
    home: LonLat | None = None  # where it took off and returns to, of one that is in the air already; else that is its position
    own_figures: tuple[str, ...] = field(default=(), compare=False)  # of a stored UAV: those that are said for this mission
    fleet_figures: Mapping[str, Any] = field(default_factory=dict, compare=False)  # of the own figures: what the stored UAV has instead

    @property
    def returns_to(self) -> LonLat:
        return self.position if self.home is None else self.home


@dataclass(frozen=True)
class TargetRequest:
    """An asset, a point or stretch on one, or a bare position. Neither asset nor position: the asset has been deleted.

    `uav` is the name of the only UAV that may do it, `sensor` what its UAV must have; empty: any.
    """

    asset: int | None = None
    position: LonLat | None = None
    stretch: tuple[LonLat, LonLat] | None = None
    task: Task | None = None
    priority: Priority = Priority.NORMAL
    uav: str = ""
    sensor: str = ""
    external_id: str = field(default="", compare=False)  # of another system, as are the attributes: no plan hangs on them
    attributes: Mapping[str, Any] = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class LockRequest:
    """A run of targets, by their places in the request, that the UAV of this name flies in this order with nothing between."""

    uav: str
    targets: tuple[int, ...]
    at_start: bool = False
    at_end: bool = False


@dataclass(frozen=True)
class BaseRequest:
    """A place where UAVs may land."""

    name: str
    position: LonLat


@dataclass(frozen=True)
class LostLinkRequest:
    """What UAVs do when their link is lost for good; hold_s before they return, only with hold."""

    behaviour: LostLink = LostLink.GO_ON
    rally_points: tuple[LonLat, ...] = ()
    hold_s: float = 0.0


GO_ON = LostLinkRequest()


@dataclass(frozen=True)
class PlanRequest:
    """`bases` are those of the organisation when the plan was asked for; only filled in where a UAV is to land at one.

    `organisation` and `mission` are the keys of whose plan it is: other missions of the organisation that fly then are kept apart from.
    Without `departs_at` the plan is for any time. `charging_w` is the power of charging at towers on the way, if that is wished.
    """

    uavs: tuple[UavRequest, ...]
    targets: tuple[TargetRequest, ...]
    objective: Objective
    return_to_start: bool
    locks: tuple[LockRequest, ...] = ()
    bases: tuple[BaseRequest, ...] = ()
    departs_at: datetime | None = None
    conditions: Conditions = CALM
    charging_w: float | None = None
    lost_link: LostLinkRequest = GO_ON
    organisation: int | None = None
    mission: str | None = None

    def may_charge(self, uav: int) -> bool:
        """Whether this UAV, by its number, charges at towers: who flies several times takes a full battery at the base instead."""
        return self.charging_w is not None and self.uavs[uav].sorties == 1

    def end_action(self, uav: int) -> EndAction:
        """What the UAV does in the end: the wish that all return comes first."""
        return EndAction.RETURN if self.return_to_start else self.uavs[uav].end_action

    def route_end(self, uav: int) -> End:
        """Where the UAV's route ends, as the solver counts it."""
        return ROUTE_ENDS[self.end_action(uav)]


class InvalidRequest(Exception):
    """The request cannot be planned as it stands; faults by place: {"targets.0.position": …}. A text is in the user's language."""

    def __init__(self, faults: Mapping[str, Reason | str]) -> None:
        super().__init__("; ".join(f"{place}: {fault}" for place, fault in faults.items()))
        self.faults = dict(faults)


def priority_to_json(priority: Priority) -> str:
    return priority.name.lower()


def priority_from_json(value: str) -> Priority:
    return Priority[value.upper()]


def lock_to_json(lock: LockRequest) -> dict[str, Any]:
    return {"uav": lock.uav, "targets": list(lock.targets), "at_start": lock.at_start, "at_end": lock.at_end}


def lock_from_json(value: dict[str, Any]) -> LockRequest:
    return LockRequest(value["uav"], tuple(value["targets"]), value["at_start"], value["at_end"])


def lost_link_to_json(lost_link: LostLinkRequest) -> dict[str, Any]:
    return {
        "behaviour": lost_link.behaviour.value,
        "rally_points": [list(at) for at in lost_link.rally_points],
        "hold_s": lost_link.hold_s,
    }


def lost_link_from_json(value: dict[str, Any]) -> LostLinkRequest:
    return LostLinkRequest(
        LostLink(value.get("behaviour", LostLink.GO_ON)),
        tuple(LonLat(*at) for at in value.get("rally_points", ())),
        float(value.get("hold_s", 0.0)),
    )


def moment_to_json(moment: datetime | None) -> str | None:
    return None if moment is None else moment.astimezone(UTC).isoformat().replace("+00:00", "Z")


def moment_from_json(value: str | None) -> datetime | None:
    return None if value is None else datetime.fromisoformat(value)


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
                "most_targets": uav.most_targets,
                "sensors": list(uav.sensors),
                "performance": performance_to_json(uav.performance),
                "sorties": uav.sorties,
                "home": None if uav.home is None else list(uav.home),
                "own_figures": list(uav.own_figures),
                "fleet_figures": dict(uav.fleet_figures),
            }
            for uav in request.uavs
        ],
        "targets": [
            {
                "asset": target.asset,
                "position": list(target.position) if target.position else None,
                "stretch": [list(end) for end in target.stretch] if target.stretch else None,
                "task": task_to_json(target.task) if target.task else None,
                "priority": priority_to_json(target.priority),
                "uav": target.uav,
                "sensor": target.sensor,
                "external_id": target.external_id,
                "attributes": dict(target.attributes),
            }
            for target in request.targets
        ],
        "objective": request.objective.value,
        "return_to_start": request.return_to_start,
        "locks": [lock_to_json(lock) for lock in request.locks],
        "bases": [{"name": base.name, "position": list(base.position)} for base in request.bases],
        "departs_at": moment_to_json(request.departs_at),
        "conditions": conditions_to_json(request.conditions),
        "charging_w": request.charging_w,
        "lost_link": lost_link_to_json(request.lost_link),
        "organisation": request.organisation,
        "mission": request.mission,
    }


def request_from_json(value: dict[str, Any]) -> PlanRequest:
    """A job may have been stored before there were priorities, ties, sensors, limits, locks, bases, departures and conditions."""
    return PlanRequest(
        uavs=tuple(
            UavRequest(
                name=uav["name"],
                position=LonLat(*uav["position"]),
                max_range_m=uav["max_range_m"],
                cruise_speed_mps=uav["cruise_speed_mps"],
                end_action=EndAction(uav["end_action"]),
                uav=uav["uav"],
                most_targets=uav.get("most_targets"),
                sensors=tuple(uav.get("sensors", ())),
                performance=performance_from_json(uav.get("performance", {})),
                sorties=uav.get("sorties", 1),
                home=LonLat(*uav["home"]) if uav.get("home") else None,
                own_figures=tuple(uav.get("own_figures", ())),
                fleet_figures=uav.get("fleet_figures", {}),
            )
            for uav in value["uavs"]
        ),
        targets=tuple(
            TargetRequest(
                asset=target["asset"],
                position=LonLat(*target["position"]) if target["position"] else None,
                stretch=(LonLat(*target["stretch"][0]), LonLat(*target["stretch"][1])) if target["stretch"] else None,
                task=task_from_json(target["task"]),
                priority=priority_from_json(target.get("priority", "normal")),
                uav=target.get("uav", ""),
                sensor=target.get("sensor", ""),
                external_id=target.get("external_id", ""),
                attributes=target.get("attributes", {}),
            )
            for target in value["targets"]
        ),
        objective=Objective(value["objective"]),
        return_to_start=value["return_to_start"],
        locks=tuple(lock_from_json(lock) for lock in value.get("locks", ())),
        bases=tuple(BaseRequest(base["name"], LonLat(*base["position"])) for base in value.get("bases", ())),
        departs_at=moment_from_json(value.get("departs_at")),
        conditions=conditions_from_json(value.get("conditions") or {}),
        charging_w=value.get("charging_w"),
        lost_link=lost_link_from_json(value.get("lost_link") or {}),
        organisation=value.get("organisation"),
        mission=value.get("mission"),
    )
