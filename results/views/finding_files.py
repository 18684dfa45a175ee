"""Findings as files, generated while they are sent."""

import json
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from django.http import StreamingHttpResponse
from drf_spectacular.types import OpenApiTypes
from drf_spectacular.utils import OpenApiParameter, extend_schema
from rest_framework.views import APIView

from inspection.exporters.text_pieces import Value, cell, collection_pieces, csv_pieces
from results.models import Finding
from results.selectors.findings import exported, findings_that_match
from results.views.findings import FILTERS, asked_findings, category_name
from workspace.api.renderers import OneAnswer
from workspace.api.signed_in import SignedInRequest

COLUMNS = (
    "number", "severity", "state", "category", "category_name", "asset_id", "asset_label", "note", "due_on", "work_reference",
    "first_seen_at", "last_seen_at", "done_at", "mission", "photos",
)  # fmt: skip


def _values(finding: Finding) -> dict[str, Value]:
    times: dict[str, Any] = {name: getattr(finding, name) for name in ("first_seen_at", "last_seen_at", "done_at", "due_on")}
    values: dict[str, Value] = {
        "number": finding.number,
        "severity": finding.severity,
        "state": finding.state,
        "category": finding.category,
        "category_name": category_name(finding),
        "asset_id": finding.asset_id,
        "asset_label": finding.asset_label,
        "note": finding.note,
        "work_reference": finding.work_reference,
        "mission": "" if finding.mission_id is None else str(finding.mission_id),
        "photos": len({row.medium_id for row in finding.evidence.all()}),
    }
    return values | {name: None if value is None else value.isoformat() for name, value in times.items()}


def _csv(findings: Iterable[Finding]) -> Iterator[str]:
    def row(finding: Finding) -> list[Value]:
        values, position = _values(finding), finding.position
        place = (None, None) if position is None else (f"{position.x:.7f}", f"{position.y:.7f}")
        return [*(cell(values[name]) for name in COLUMNS), *place]

    return csv_pieces([*COLUMNS, "longitude_deg", "latitude_deg"], map(row, findings))


def _geojson(findings: Iterable[Finding]) -> Iterator[str]:
    def feature(finding: Finding) -> str:
        values, position = _values(finding), finding.position
        geometry = None if position is None else {"type": "Point", "coordinates": [position.x, position.y]}
        found: dict[str, Any] = {"type": "Feature", "id": str(finding.pk), "geometry": geometry}
        return json.dumps(found | {"properties": {name: values[name] for name in COLUMNS}}, ensure_ascii=False)

    return collection_pieces(map(feature, findings))


KINDS: dict[str, tuple[str, Callable[[Iterable[Finding]], Iterator[str]]]] = {
    "csv": ("text/csv; charset=utf-8", _csv),
    "geojson": ("application/geo+json", _geojson),
}
KIND = OpenApiParameter("kind", str, OpenApiParameter.PATH, enum=[*KINDS], description="how the file ends")
FILES: dict[Any, Any] = {(200, "text/csv"): OpenApiTypes.STR, (200, "application/geo+json"): OpenApiTypes.OBJECT}


class FindingFile(APIView):
    content_negotiation_class = OneAnswer
    throttle_scope = "exports"

    @extend_schema(
        operation_id="export_findings",
        summary="Findings as CSV or GeoJSON",
        tags=["findings"],
        parameters=[KIND, *FILTERS],
        responses=FILES,
    )
    def get(self, request: SignedInRequest, kind: str) -> StreamingHttpResponse:
        media_type, pieces = KINDS[kind]
        findings = findings_that_match(request.user.organisation_id, asked_findings(request))
        response = StreamingHttpResponse(pieces(exported(findings)), content_type=media_type)
        response["Content-Disposition"] = f'attachment; filename="findings.{kind}"'
        response["Cache-Control"] = "private, no-cache"
        return response
