"""How good the watch's estimates are, and how many it makes, as it is told outside."""

from collections import Counter
from collections.abc import Iterable
from typing import Protocol

from inspection.geodesy import LonLat
from operation.metrics import ESTIMATED_UAVS, ESTIMATOR_ERROR_M, ESTIMATOR_INNOVATIONS
from telemetry.estimation.innovation import innovation
from telemetry.estimation.report import Report
from telemetry.estimation.tracker import Tracker
from telemetry.services.watches import Made

JUDGED_EVERY_S = 10.0  # of a UAV, or where its reports are farther apart at each


class Judged(Protocol):
    """A UAV that is watched."""

    tracker: Tracker
    judged_s: float


def judge(watched: Judged, report: Report) -> None:
    """Before the estimator takes the report: what did it think of this moment? One in a while tells enough, and costs nothing."""
    told, newest = report.measurement, watched.tracker.newest
    if newest is None or report.measured_s <= newest.measured_s or report.measured_s < watched.judged_s + JUDGED_EVERY_S:
        return
    if told.longitude_deg is None or told.latitude_deg is None:
        return
    watched.judged_s = report.measured_s
    estimate = watched.tracker.estimate(report.measured_s)
    if estimate is None or estimate.is_lost:
        return
    found = innovation(estimate, LonLat(told.longitude_deg, told.latitude_deg))
    ESTIMATOR_ERROR_M.observe(found.error_m)
    ESTIMATOR_INNOVATIONS.labels("within" if found.is_within else "outside").inc()


def count_states(made: Iterable[Made], *, held: int) -> None:
    """UAVs by what is known of them."""
    states = Counter({"measured": 0, "estimated": 0, "lost": 0})
    for one in made:
        states["lost" if one.estimate.is_lost else "measured" if one.estimate.is_measured else "estimated"] += 1
    states["unknown"] = held - states.total()
    for state, number in states.items():
        ESTIMATED_UAVS.labels(state).set(number)
