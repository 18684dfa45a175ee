"""Checks that later apps add to imports that are applied without review."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from django.contrib.gis.geos import GEOSGeometry
from django.db import connection
from django.db.models import Max
from django.utils.module_loading import import_string

from inspection.models import DataImport, NoFlyZone
from operation.reasons import Why
from workspace.models import AuditEntry

_checks: list[str] = []
_SHAPES = """
CREATE TEMPORARY TABLE written_ground ON COMMIT DROP AS
SELECT e.subject_type AS subject, ST_SetSRID(ST_GeomFromGeoJSON(facts->>'geometry'), 4326) AS geometry
FROM workspace_auditentry e CROSS JOIN LATERAL (VALUES (e.before), (e.after)) AS sides (facts)
WHERE e.id > %(entry)s AND e.subject_type IN ('asset', 'zone') AND jsonb_typeof(facts->'geometry') = 'object'
UNION ALL SELECT 'asset', geometry FROM inspection_asset WHERE data_import_id = %(data_import)s
UNION ALL SELECT 'zone', geometry FROM inspection_noflyzone WHERE id > %(zone)s
"""
_NEAR = """
SELECT EXISTS (
    SELECT FROM written_ground, (SELECT ST_SetSRID(%(shape)s::geometry, 4326)::geography AS place) AS asked
    WHERE subject = %(subject)s AND geometry && ST_Buffer(place, %(within_m)s)::geometry
      AND ST_DWithin(geometry::geography, place, %(within_m)s)
)
"""


@dataclass(frozen=True)
class AutoApplyRefusal:
    """A reason against applying an import automatically."""

    code: str
    why: Why


@dataclass(frozen=True)
class GroundMark:
    """The end of history and zones before an import writes. Make it while holding hold_ground."""

    entry: int
    zone: int


@dataclass(frozen=True)
class WrittenGround:
    """All that an import has written in the open transaction, before and after, whatever its size."""

    mark: GroundMark

    def changes_any_of(self, asset_ids: Collection[int]) -> bool:
        """Whether one of these assets is changed or vanishes."""
        entries = AuditEntry.objects.filter(pk__gt=self.mark.entry, subject_type="asset", subject_id__in=[str(key) for key in asset_ids])
        return bool(asset_ids) and entries.exists()

    def has_assets_within(self, shape: GEOSGeometry, within_m: float) -> bool:
        return self._is_near("asset", shape, within_m)

    def has_zones_within(self, shape: GEOSGeometry, within_m: float) -> bool:
        return self._is_near("zone", shape, within_m)

    def _is_near(self, subject: str, shape: GEOSGeometry, within_m: float) -> bool:
        with connection.cursor() as cursor:
            cursor.execute(_NEAR, {"subject": subject, "shape": shape.wkt, "within_m": within_m})
            return bool(cursor.fetchone()[0])


def register_check(name: str) -> None:
    """Register a function by its dotted name. It takes a WrittenGround and lists reasons against it. It is imported on first use."""
    if name not in _checks:
        _checks.append(name)


def ground_mark() -> GroundMark:
    return GroundMark(
        entry=AuditEntry.objects.aggregate(last=Max("pk"))["last"] or 0, zone=NoFlyZone.objects.aggregate(last=Max("pk"))["last"] or 0
    )


def further_reasons(mark: GroundMark, data_import: DataImport) -> list[AutoApplyRefusal]:
    """Return the reasons of later apps against what was written since the mark, within the transaction that wrote it."""
    with _shapes(mark, data_import):
        return [reason for name in _checks for reason in import_string(name)(WrittenGround(mark))]


@contextmanager
def _shapes(mark: GroundMark, data_import: DataImport) -> Iterator[None]:
    values: dict[str, Any] = {"entry": mark.entry, "zone": mark.zone, "data_import": data_import.pk}
    with connection.cursor() as cursor:
        cursor.execute(_SHAPES, values)
        cursor.execute("CREATE INDEX ON written_ground USING gist (geometry)")
        cursor.execute("ANALYZE written_ground")
        yield
        cursor.execute("DROP TABLE written_ground")
