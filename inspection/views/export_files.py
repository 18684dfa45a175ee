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
MEDIA_TYPES = {"csv": "text/csv; charset=utf-8", "geojson": "application/geo+json", "gpkg": "application/geopackage+sqlite3"}
FORMAT = OpenApiParameter("ending", str, OpenApiParameter.PATH, enum=[*MEDIA_TYPES], description="how the file ends")
FILE_ANSWERS: dict[Any, Any] = {
    **{(200, kind.partition(";")[0]): OpenApiTypes.BINARY for kind in MEDIA_TYPES.values()},
    409: OpenApiResponse(description="Nothing or too much to export."),
}


def check_number(found: QuerySet[Any], *, none: str, too_many: str) -> None:
    """Raise ApiProblem 409 with one of the texts unless 1 to MAX_EXPORTED rows are found; too_many names this number as %(most)s."""
    count = found.order_by()[: MAX_EXPORTED + 1].count()
    if count == 0:
        raise ApiProblem(409, "nothing_found", none)
    if count > MAX_EXPORTED:
        raise ApiProblem(409, "too_many", too_many % {"most": f"{MAX_EXPORTED:,}"})


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
