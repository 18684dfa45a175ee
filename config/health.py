"""For whoever watches over the program: is the process alive, can it work, and could a mission be planned now?"""

from collections.abc import Callable
from typing import Any

from django.db import Error as DatabaseError
from django.http import HttpRequest, HttpResponse, JsonResponse
from django.views.decorators.cache import never_cache
from django.views.decorators.http import require_safe

from config.warming import warming_faults
from inspection.models import Asset, GraphSnapshot
from operation.readiness import NO_DATABASE, database_faults, redis_faults


@never_cache
@require_safe
def healthz(request: HttpRequest) -> JsonResponse:
    """The process answers; it asks nobody else."""
    return JsonResponse({"alive": True})


@never_cache
@require_safe
def readyz(request: HttpRequest) -> JsonResponse:
    """200 when database, migrations and Redis are there and the process is warm, else 503 with the reasons.

    `missing` is what keeps missions from being planned: people bring it, so it keeps nobody out.
    """
    reasons = [*database_faults(), *redis_faults(), *warming_faults()]
    answer: dict[str, Any] = {"ready": not reasons}
    if reasons:
        answer["reasons"] = reasons
    if not reasons and (missing := missing_ground()):
        answer["missing"] = missing
    return JsonResponse(answer, status=503 if reasons else 200)


def missing_ground() -> list[str]:
    """Without which nothing can be planned."""
    try:
        missing = []
        if not Asset.objects.filter(vanished_at=None).exists():
            missing.append("no data is imported")
        if not GraphSnapshot.objects.exists():
            missing.append("no graph is built")
        return missing
    except DatabaseError:
        return [NO_DATABASE]


PROBES: dict[str, Callable[[HttpRequest], HttpResponse]] = {"/healthz": healthz, "/readyz": readyz}
