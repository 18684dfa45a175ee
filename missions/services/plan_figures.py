"""How many plans are made, how large, by which method, and how long each takes."""

from collections.abc import Callable, Mapping
from functools import wraps
from time import perf_counter
from typing import Any, ParamSpec

from operation.metrics import PLAN_SECONDS, PLANS, PLANS_REFUSED

SIZES = ((3, "1-3"), (12, "4-12"), (50, "13-50"), (200, "51-200"))  # targets at most, and what that is called
LARGEST = "201-"

P = ParamSpec("P")


def size_of(targets: int) -> str:
    return next((name for most, name in SIZES if targets <= most), LARGEST)


def counted(make: Callable[P, dict[str, Any]]) -> Callable[P, dict[str, Any]]:
    """Of a function that makes a plan of its keyword argument `request`, or raises why it cannot."""

    @wraps(make)
    def make_and_count(*args: P.args, **kwargs: P.kwargs) -> dict[str, Any]:
        began_s = perf_counter()
        try:
            plan = make(*args, **kwargs)
        except Exception as error:
            PLANS_REFUSED.labels(type(error).__name__).inc()
            raise
        request: Any = kwargs["request"]
        size, method = size_of(len(request.targets)), _method_of(plan)
        PLANS.labels(size, method).inc()
        PLAN_SECONDS.labels(size, method).observe(perf_counter() - began_s)
        return plan

    return make_and_count


def _method_of(plan: Mapping[str, Any]) -> str:
    quality = plan.get("quality")
    return str(quality["method"]) if isinstance(quality, Mapping) and "method" in quality else "unknown"
