"""Plans on the map of now: the context read, the plan made, and checked again where the map has changed meanwhile."""

import logging
from collections.abc import Callable, Mapping
from functools import wraps
from time import perf_counter
from typing import Any, ParamSpec
from uuid import uuid4

from django.conf import settings

from inspection.selectors.planning import current_dataset_version, planning_read, terrain_at
from missions.selectors.planning_context import planning_context, read_targets
from operation.metrics import PLAN_SECONDS, PLANS, PLANS_REFUSED
from operation.reasons import Reason
from planning.checks.constraints import ZoneNotAvoided
from planning.context import PlanningContext
from planning.context_file import write_context
from planning.plan_json import plan_to_json
from planning.planner import ZonesNotSettled, plan, plan_on_map
from planning.progress import OnPlanProgress, PlanProgress, no_progress
from planning.request import PlanRequest
from planning.solver.solver import Stop, never
from workspace.jobs.planning_lock import hold_planning_lock, release_planning_lock

SIZES = ((3, "1-3"), (12, "4-12"), (50, "13-50"), (200, "51-200"))  # targets at most, and what that is called
ABOVE_ALL_SIZES = "201-"
P = ParamSpec("P")
PLANNER_FAULTS = (ZoneNotAvoided, ArithmeticError, AssertionError, LookupError, TypeError, ValueError)
MAX_KEPT_CONTEXTS = 20  # of plans that failed

logger = logging.getLogger(__name__)
MAX_CONTEXTS = 5  # that may follow one another while one plan is made


class GraphOutdated(Exception):
    """The zones change faster than a plan can be made."""

    def __init__(self) -> None:
        super().__init__(str(Reason("zones_changing")))


def size_of(targets: int) -> str:
    return next((name for most, name in SIZES if targets <= most), ABOVE_ALL_SIZES)


def counted(make: Callable[P, dict[str, Any]]) -> Callable[P, dict[str, Any]]:
    """Of a function that makes a plan of its keyword argument `request`, or raises why it cannot."""

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
    """Write what a plan that failed was made from, for replay_plan, if the settings name a folder and it holds few yet."""
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
    as_text: bool = False,
) -> dict[str, Any]:
    """The plan in the shape of the API, on demand with parts of it `as_text` (see plan_to_json).

    Raises InvalidRequest, NoGraph or GraphOutdated.
    """
    on_progress(PlanProgress(0.0, Reason("looking_up_targets")))
    ground, targets, deleted = read_targets(request)
    for _ in range(MAX_CONTEXTS):
        context = planning_context(request, ground, targets, deleted)
        terrain = terrain_at(ground.dataset_version)
        try:
            with hold_planning_lock():
                found = plan(context, request, stop=stop, on_progress=on_progress, seed=seed, search_s=search_s)
                answer = plan_to_json(found, as_text=as_text)
        except ZonesNotSettled as error:
            raise GraphOutdated from error
        except PLANNER_FAULTS:
            _keep_context(context, request)
            raise
        release_planning_lock()  # which is the caller's, if it had one already: nobody waits for another turn after the last check
        if current_dataset_version() == ground.dataset_version:
            return answer
        # Only what was checked against the zones of this moment, over the terrain that its heights belong to, leaves.
        ground = planning_read().ground()
        context = planning_context(request, ground, targets, deleted)
        still_clear = plan_on_map(found, context) if terrain_at(ground.dataset_version) == terrain else None
        if still_clear is not None:
            return plan_to_json(still_clear, as_text=as_text)
    raise GraphOutdated
