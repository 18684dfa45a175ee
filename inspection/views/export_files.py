"""Answers that are files of assets or zones."""

from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from django.db.models import QuerySet
from django.http import FileResponse, HttpResponseBase, StreamingHttpResponse
from django.utils import timezone
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, OpenApiResponse

from inspection.exporters.geopackage import write_geopackage
from inspection.exporters.rows import Columns, ExportRow, rows_as_csv, rows_as_geojson
from workspace.api.errors import ApiProblem

MAX_EXPORTED = 200_000  # as many as a file may bring in
MAX_DIRECT = 10_000  # rows of a GeoPackage that is written while the request waits, some 2 s
MEDIA_TYPES = {"csv": "text/csv; charset=utf-8", "geojson": "application/geo+json", "gpkg": "application/geopackage+sqlite3"}
FORMAT = OpenApiParameter("ending", str, OpenApiParameter.PATH, enum=[*MEDIA_TYPES], description="how the file ends")
FILE_ANSWERS: dict[Any, Any] = {
    **{(200, kind.partition(";")[0]): OpenApiTypes.BINARY for kind in MEDIA_TYPES.values()},
    409: OpenApiResponse(description="Nothing or too much to export."),
}


def most_of(ending: str) -> int:
    """Return how many rows a file has at most that is not written by a job: text is sent while it is made."""
    return min(MAX_DIRECT, MAX_EXPORTED) if ending == "gpkg" else MAX_EXPORTED


def check_number(found: QuerySet[Any], most: int, *, none: str, too_many: str) -> int:
    """Return the number of rows. Raises ApiProblem 409 with one of the texts unless it is 1 to `most`; too_many names this as %(most)s."""
    count = found.order_by()[: most + 1].count()
    if count == 0:
        raise ApiProblem(409, "nothing_found", none)
    if count > most:
        raise ApiProblem(409, "too_many", too_many % {"most": f"{most:,}"})
    return count


def file_response(rows: Iterator[ExportRow], columns: Columns, ending: str, stem: str) -> HttpResponseBase:
    response: HttpResponseBase
    if ending == "gpkg":
        with TemporaryDirectory() as folder:
            path = Path(folder) / f"{stem}.gpkg"
            write_geopackage(path, rows, columns, timezone.now())
            response = FileResponse(path.open("rb"), content_type=MEDIA_TYPES[ending])  # an open file outlives its name
    else:
        pieces = rows_as_csv if ending == "csv" else rows_as_geojson
        response = StreamingHttpResponse(pieces(rows, columns), content_type=MEDIA_TYPES[ending])
    response["Content-Disposition"] = f'attachment; filename="{stem}.{ending}"'
    response["Cache-Control"] = "private, no-cache"
    return response
