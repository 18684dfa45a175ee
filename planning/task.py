"""What is done at a target and at a waypoint."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from planning.views.camera import Camera, camera_from_json, camera_to_json

MAX_HOLD_S = 3_600.0
INSPECTION_SPEEDS_MPS = (0.5, 50.0)  # that may be asked for
VIEWS_HOLD_S = 3.0  # at each photo of a view plan: until the UAV and its camera stand still, and for the photo
VIEWS_HOLDS_S = (2.0, 60.0)  # that may be asked for
TURN_S = 3.0  # longer where the UAV has to turn its nose: half a turn at the usual 60 degrees a second
MM_PER_M = 1_000.0


class TaskKind(StrEnum):
    LOOK = "look"  # slow down and film the asset in passing
    PHOTO = "photo"  # stand still for sharp pictures
    HOLD = "hold"  # hover over the place


# Seconds at the target when the operator names the kind of task alone: a look in passing, one round of pictures, a longer hover.
DEFAULT_HOLD_S = {TaskKind.LOOK: 5.0, TaskKind.PHOTO: 10.0, TaskKind.HOLD: 30.0}


class ViewPattern(StrEnum):
    DETAIL = "detail"  # every part, at the ground sample distance
    OVERVIEW = "overview"  # the whole, from four sides
    SPANS = "spans"  # the wires up to the middle of each span, from both sides


OVERVIEW_GSD_M = 0.05  # what is coarser counts as not shown by an overview


@dataclass(frozen=True)
class ViewsRequest:
    """Photos of a target from planned poses. gsd_m: ground sample distance, what a pixel may show at most."""

    gsd_m: float
    camera: Camera
    min_height_m: float = 4.0  # of the UAV above the ground
    pattern: ViewPattern = ViewPattern.DETAIL


@dataclass(frozen=True)
class View:
    """How one photo is taken.

    yaw_deg: of the camera from true north, clockwise; pitch_deg: 0 is the horizon, -90 straight down; distance_m: along the optical axis
    to what it shows; clearance_m: which the flight through this photo and its neighbours keeps from wires and supports; heading_deg: of
    the UAV's nose, where the gimbal cannot pan all around; None: any.
    """

    yaw_deg: float
    pitch_deg: float
    distance_m: float
    focal_length_mm: float
    clearance_m: float
    heading_deg: float | None = None


@dataclass(frozen=True)
class Task:
    """What is done at a target; the UAV stays `hold_s` seconds, or as long at each photo of `views`. view: of a waypoint's one photo.

    speed_mps: over ground along a line, at most; None: as the UAV flies.
    """

    kind: TaskKind
    hold_s: float
    views: ViewsRequest | None = None
    view: View | None = None
    speed_mps: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 <= self.hold_s <= MAX_HOLD_S:
            raise ValueError(f"hold_s must be from 0 to {MAX_HOLD_S:.0f}")
        if self.kind is not TaskKind.PHOTO and (self.views is not None or self.view is not None):
            raise ValueError("only photos have views")
        if self.speed_mps is not None and not (
            self.kind is TaskKind.LOOK and INSPECTION_SPEEDS_MPS[0] <= self.speed_mps <= INSPECTION_SPEEDS_MPS[1]
        ):
            raise ValueError("only a look along a line has a speed, of 0.5 to 50 m/s")


def default_task(asset_kind: str | None, *, is_path: bool) -> Task:
    """The task of a target for which the operator names none.

    Towers and bridges have details to photograph; a line or railway flown end to end is filmed without stopping, a single point on it
    is looked at; over a bare position the UAV hovers.
    """
    if is_path:
        return Task(TaskKind.LOOK, 0.0)
    if asset_kind in {"tower", "bridge"}:
        return Task(TaskKind.PHOTO, DEFAULT_HOLD_S[TaskKind.PHOTO])
    if asset_kind is None:
        return Task(TaskKind.HOLD, 10.0)
    return Task(TaskKind.LOOK, DEFAULT_HOLD_S[TaskKind.LOOK])


def task_to_json(task: Task) -> dict[str, Any]:
    """Return kind and hold_s; `views`, `view` and `speed_mps` where there are any, as documents that are older have none."""
    value: dict[str, Any] = {"kind": task.kind.value, "hold_s": task.hold_s}
    if task.views is not None:
        value["views"] = views_to_json(task.views)
    if task.view is not None:
        value["view"] = vars(task.view).copy()
    if task.speed_mps is not None:
        value["speed_mps"] = task.speed_mps
    return value


def task_from_json(value: Mapping[str, Any] | None) -> Task | None:
    if not value:
        return None
    views, view = value.get("views"), value.get("view")
    return Task(
        TaskKind(value["kind"]),
        float(value["hold_s"]),
        None if views is None else views_from_json(views),
        None if view is None else View(**view),
        value.get("speed_mps"),
    )


def views_to_json(views: ViewsRequest) -> dict[str, Any]:
    """Return the request; `pattern` where it is not that of every part, as documents that are older have none."""
    value = {"gsd_mm": round(views.gsd_m * MM_PER_M, 6), "min_height_m": views.min_height_m, "camera": camera_to_json(views.camera)}
    return value if views.pattern is ViewPattern.DETAIL else value | {"pattern": views.pattern.value}


def views_from_json(value: Mapping[str, Any]) -> ViewsRequest:
    pattern = ViewPattern(value.get("pattern", ViewPattern.DETAIL))
    return ViewsRequest(value["gsd_mm"] / MM_PER_M, camera_from_json(value["camera"]), value["min_height_m"], pattern)
