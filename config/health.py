"""For whoever watches over the program: is the process alive, and can it work?"""

from typing import Any

from django.core.cache import cache
from django.db import Error as DatabaseError
from django.db import connection
from django.db.migrations.executor import MigrationExecutor
from django.http import HttpRequest, JsonResponse
from django.views.decorators.cache import never_cache
from django.views.decorators.http import require_safe

from inspection.models import Asset, GraphSnapshot
from workspace.cache_absence import CACHE_AWAY


@never_cache
@require_safe
def healthz(request: HttpRequest) -> JsonResponse:
    """The process answers; it asks nobody else."""
    return JsonResponse({"alive": True})


@never_cache
@require_safe
def readyz(request: HttpRequest) -> JsonResponse:
    """200 when a mission could be planned now, else 503 with what is missing."""
    reasons = [*_database_faults(), *_redis_faults()]
    answer: dict[str, Any] = {"ready": not reasons}
    if reasons:
        answer["reasons"] = reasons
    return JsonResponse(answer, status=503 if reasons else 200)


def _database_faults() -> list[str]:
    try:
        executor = MigrationExecutor(connection)
        if executor.migration_plan(executor.loader.graph.leaf_nodes()):
            return ["migrations are not applied"]
        faults = []
        if not Asset.objects.filter(vanished_at=None).exists():
            faults.append("no data is imported")
        if not GraphSnapshot.objects.exists():
            faults.append("no graph is built")
        return faults
    except DatabaseError:
        return ["the database cannot be reached"]


def _redis_faults() -> list[str]:
    try:
        cache.get("ready")
    except CACHE_AWAY:
        return ["Redis cannot be reached"]
    return []
