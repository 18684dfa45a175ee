"""GeoPackages of the registers that a job writes; each is kept like an upload until it is forgotten."""

from collections.abc import Iterator
from dataclasses import asdict
from datetime import datetime
from functools import partial
from typing import Any

from django.db import transaction
from django.utils import timezone

from inspection.exporters.geopackage import write_geopackage
from inspection.exporters.rows import ExportRow
from inspection.models import Upload
from inspection.selectors.register.assets import AssetFilter
from inspection.selectors.register.zones import ZoneFilter
from inspection.serializers.export_rows import ASSET_COLUMNS, ZONE_COLUMNS, asset_rows, zone_rows
from inspection.services.imports.uploads import PART_BYTES, private_folder, store_upload
from inspection.services.proposals.reading import Progress
from operation.reasons import Reason
from workspace.jobs.services import JobCancelled, cancel_is_requested, cancel_job, create_job_within, finish_job
from workspace.models import Job, User

EXPORT_TASK = "inspection.tasks.export_register"
MAX_OPEN = 5  # jobs of one user
MAX_KEPT = 3  # files of one user
ROWS_A_REPORT = 500
_TIMES = ("inspected_from", "inspected_before", "active_at")
_WRITERS: dict[str, Any] = {"assets": (AssetFilter, asset_rows, ASSET_COLUMNS), "zones": (ZoneFilter, zone_rows, ZONE_COLUMNS)}


def ask_for_export(*, register: str, wanted: AssetFilter | ZoneFilter, rows: int, actor: User) -> Job:
    """Create the job that writes what a filter finds; the caller sends it to its queue after the commit. Raises TooManyJobs."""
    stated = asdict(wanted) | {name: value.isoformat() for name in _TIMES if (value := getattr(wanted, name, None)) is not None}
    parameters = {"register": register, "filter": stated, "rows": rows}
    return create_job_within(
        MAX_OPEN, organisation=actor.organisation, created_by=actor, task=EXPORT_TASK, parameters=parameters,
        message=Reason("waiting_to_be_written"),
    )  # fmt: skip


def export_register(*, job: Job, progress: Progress) -> None:
    """Write the file of a job and keep it under the key of the job; one that was interrupted begins again."""
    name = job.parameters["register"]
    kind, rows_of, columns = _WRITERS[name]
    rows = _reported(rows_of(_filter(kind, job.parameters["filter"])), int(job.parameters["rows"]), progress)
    with private_folder() as folder:
        path = folder / f"{name}.gpkg"
        write_geopackage(path, rows, columns, timezone.now())
        with transaction.atomic(), path.open("rb") as file:
            chunks = iter(partial(file.read, PART_BYTES), b"")
            upload = store_upload(file_name=path.name, chunks=chunks, created_by=job.created_by, key=job.pk)
            _forget_older(job)
            result = {"file_name": path.name, "size_bytes": upload.size_bytes}
            if cancel_is_requested(job=job) or not finish_job(job=job, result=result, message=Reason("file_written")):
                raise JobCancelled


def forget_export(*, job: Job) -> None:
    """Stop the job of an export, and delete its file."""
    with transaction.atomic():
        cancel_job(job=job)
        Upload.objects.filter(pk=job.pk).delete()


def _filter(kind: type[Any], stated: dict[str, Any]) -> AssetFilter | ZoneFilter:
    """Return the filter as it was, from JSON."""
    values = {name: tuple(value) if isinstance(value, list) else value for name, value in stated.items()}
    times = {name: datetime.fromisoformat(str(values[name])) for name in _TIMES if values.get(name)}
    found: AssetFilter | ZoneFilter = kind(**values | times)
    return found


def _reported(rows: Iterator[ExportRow], expected: int, progress: Progress) -> Iterator[ExportRow]:
    for number, row in enumerate(rows):
        if number % ROWS_A_REPORT == 0:
            progress(Reason("writing"), min(number / expected, 1.0))
        yield row


def _forget_older(job: Job) -> None:
    done = Job.objects.filter(created_by=job.created_by, task=EXPORT_TASK).exclude(pk=job.pk).order_by("-created_at")
    kept = list(done.filter(pk__in=Upload.objects.filter(created_by=job.created_by).values("pk")).values_list("pk", flat=True))
    Upload.objects.filter(pk__in=kept[MAX_KEPT - 1 :]).delete()
