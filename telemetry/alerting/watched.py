"""One UAV as the watch sees it at one moment: what every detector looks at first. Times are Unix seconds."""

from dataclasses import dataclass
from uuid import UUID

from missions.mavlink.frozen import FrozenRoute
from telemetry.decoding.measurement import Measurement
from telemetry.estimation.estimate import Estimate


@dataclass(frozen=True, slots=True)
class Report:
    """What a UAV said of one moment, by its clock and by the server's."""

    measured_s: float
    received_s: float
    measurement: Measurement


@dataclass(frozen=True, slots=True)
class WatchedUav:
    """A UAV of a mission that was sent to it or flies.

    `approval_id` and `route` are of the approval in force, `flight` is the one of the route that it flies or will fly next, from 1 on.
    `newest` is its newest report that is not from the future, None before the first. All else (its link, what it holds, commands, zones)
    is looked up by telemetry/services/alerting.py.
    """

    uav_id: int
    organisation_id: int
    name: str
    mission_id: UUID
    approval_id: UUID | None
    route: FrozenRoute | None
    flight: int = 1
    newest: Report | None = None
    estimate: Estimate | None = None
