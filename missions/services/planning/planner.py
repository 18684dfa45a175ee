"""Plans on current map data: read the context, make the plan, check it again if the map data changed, and warm-up before the first."""

import logging
from collections.abc import Callable, Mapping
from functools import wraps
from time import perf_counter
from typing import Any, ParamSpec
from uuid import uuid4

from django.conf import settings
from django.db import Error, connections

from inspection.network.route_index import asset_places, node_tree, route_index
from inspection.network.spans import spans_of
from inspection.network.warm_up import rehearse as rehearse_ways
from inspection.selectors import NoGraph
from inspection.selectors.planning import current_dataset_version, planning_read, terrain_at
from missions.selectors.planning_context import current_airspace, planning_context, read_targets
from operation.metrics import PLAN_SECONDS, PLANS, PLANS_REFUSED
from operation.reasons import Reason
from planning.checks.constraints import ZoneNotAvoided
from planning.context import PlanningContext
from planning.context_file import write_context
from planning.plan_json import plan_to_json
from planning.planner import ZonesNotSettled, plan, plan_on_map
from planning.progress import OnPlanProgress, PlanProgress, no_progress
from planning.request import PlanRequest
from planning.solver.solver import Prover, Stop, never
from planning.solver.warm_up import rehearse as rehearse_solvers
from planning.trajectory.warm_up import rehearse as rehearse_drawing
from workspace.jobs.planning_lock import hold_planning_lock, release_planning_lock
from workspace.jobs.services import JobCancelled

SIZES = ((3, "1-3"), (12, "4-12"), (50, "13-50"), (200, "51-200"))  # maximum of targets, and the label
ABOVE_ALL_SIZES = "201-"
P = ParamSpec("P")
PLANNER_FAULTS = (ZoneNotAvoided, ArithmeticError, AssertionError, LookupError, TypeError, ValueError)
MAX_KEPT_CONTEXTS = 20  # of failed plans

logger = logging.getLogger(__name__)
MAX_CONTEXTS = 5  # successive ones for one plan


class GraphOutdated(Exception):
    """Raised when zones change faster than a plan can be made."""

    def __init__(self) -> None:
        super().__init__(str(Reason("zones_changing")))


def size_of(targets: int) -> str:
    return next((name for most, name in SIZES if targets <= most), ABOVE_ALL_SIZES)


def counted(make: Callable[P, dict[str, Any]]) -> Callable[P, dict[str, Any]]:
    """Decorate a function that makes a plan of its keyword argument `request` to count its plans and exceptions."""

    @wraps(make)
    def make_and_count(*args: P.args, **kwargs: P.kwargs) -> dict[str, Any]:
        began_s = perf_counter()
        try:
            made = make(*args, **kwargs)
        except Exception as error:
            PLANS_REFUSED.labels(type(error).__name__).inc()
            raise
        request: Any = kwargs["request"]
        size, method = size_of(len(request.targets)), _method_of(made)
        PLANS.labels(size, method).inc()
        PLAN_SECONDS.labels(size, method).observe(perf_counter() - began_s)
        return made

    return make_and_count


def _method_of(plan: Mapping[str, Any]) -> str:
    quality = plan.get("quality")
    return str(quality["method"]) if isinstance(quality, Mapping) and "method" in quality else "unknown"


def _keep_context(context: PlanningContext, request: PlanRequest) -> None:
    """Write the context of a failed plan for replay_plan, if the settings name a folder with fewer than MAX_KEPT_CONTEXTS files."""
    folder = settings.PLAN_CONTEXT_DIR
    if folder is None or len(list(folder.glob("*.zip"))) >= MAX_KEPT_CONTEXTS:
        return
    path = folder / f"{uuid4()}.zip"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_context(path, context, request)
    except OSError as error:
        logger.warning("the context of a plan that failed cannot be written: %s", error)
    else:
        logger.error("the planner failed; manage.py replay_plan %s makes the plan again", path)


@counted
def make_plan(
    *,
    request: PlanRequest,
    stop: Stop = never,
    on_progress: OnPlanProgress = no_progress,
    seed: int = 7,
    search_s: float = 0.0,
    prover: Prover | None = None,
    as_text: bool = False,
) -> dict[str, Any]:
    """Return the plan in the shape of the API, optionally with parts of it `as_text` (see plan_to_json).

    Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    on_progress(PlanProgress(0.0, Reason("looking_up_targets")))

    def on_photos(planned: int, asked: int) -> None:
        if stop():
            raise JobCancelled
        on_progress(PlanProgress(0.05 * planned / asked, Reason("planning_photos", {"target": planned + 1, "targets": asked})))

    ground, targets, deleted = read_targets(request, on_photos)
    for _ in range(MAX_CONTEXTS):
        context = planning_context(request, ground, targets, deleted)
        terrain = terrain_at(ground.dataset_version)
        try:
            with hold_planning_lock():
                found = plan(context, request, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s, prover=prover)
                answer = plan_to_json(found, as_text=as_text)
        except ZonesNotSettled as error:
            raise GraphOutdated from error
        except PLANNER_FAULTS:
            _keep_context(context, request)
            raise
        release_planning_lock()  # the caller's, if it holds one: nothing after the final check needs it
        if current_dataset_version() == ground.dataset_version:
            return answer
        if any(target.task.views is not None for target in targets):  # photos are planned on one map with all else
            ground, targets, deleted = read_targets(request, on_photos)
            continue
        # Only a plan checked against the current zones, on the terrain version of its heights, is returned.
        ground = planning_read().ground()
        context = planning_context(request, ground, targets, deleted)
        still_clear = plan_on_map(found, context) if terrain_at(ground.dataset_version) == terrain else None
        if still_clear is not None:
            return plan_to_json(still_clear, as_text=as_text)
    raise GraphOutdated


def warm_up() -> None:
    """Load the compiled core, the graph and its index. Without a graph or a database the first plan loads them."""
    rehearse_ways()
    rehearse_solvers()
    rehearse_drawing()
    try:
        airspace = current_airspace()
    except NoGraph:
        return
    except Error as error:
        logger.warning("the graph is not loaded yet: %s", error)
        return
    finally:
        connections.close_all()
    for part in (route_index, node_tree, asset_places):
        part(airspace.graph)
    asset_places(airspace.whole_graph)
    spans_of(airspace.network)
