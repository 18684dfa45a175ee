"""One UAV as the watch sees it at one moment: what every detector looks at first. Times are Unix seconds."""

from dataclasses import dataclass
from uuid import UUID

from telemetry.estimation.estimate import Estimate
from telemetry.estimation.report import Report


@dataclass(frozen=True, slots=True)
class WatchedUav:
    """A UAV of a mission that was sent to it or flies, or that is still in the air after its mission ended.

    `approval_id` is of the approval in force, `flight` the one of its route that it flies or will fly next, from 1 on; one past the last
    after all were flown. `newest` is its newest report that is not from the future, None before the first. All else (its link, what it
    holds, commands, zones) is looked up by telemetry/services/alerts/alerting.py.
    """

    uav_id: int
    organisation_id: int
    name: str
    mission_id: UUID
    approval_id: UUID
    flight: int = 1
    newest: Report | None = None
    estimate: Estimate | None = None
    is_twin: bool = False  # simulated, beside the UAV that it is the twin of
