"""The dataset revision, incremented with every change, and the derived places of supports on their lines."""

from django.db import connection
from django.db.models import F
from django.utils import timezone

from inspection.models import Ground
from inspection.network.build.joining import TOUCH_M
from inspection.network.infrastructure import NO_OSM_NODE
from workspace.leases import lock_until_end

GROUND_LOCK = 0x05A7_0001  # advisory lock: one transaction at a time writes more map data than single rows


def hold_ground() -> None:
    """Wait for a running import or edit, and lock the map data until the caller's transaction ends."""
    lock_until_end(GROUND_LOCK)


def mark_ground_changed() -> int:
    """Count one change of assets or zones and return the new revision.

    Call it in the transaction that makes the change: the row stays locked until that ends, so revisions become visible in order.
    """
    Ground.objects.get_or_create(pk=Ground.SINGLE_ID)
    Ground.objects.filter(pk=Ground.SINGLE_ID).update(revision=F("revision") + 1, changed_at=timezone.now())
    return Ground.objects.values_list("revision", flat=True).get(pk=Ground.SINGLE_ID)


REACH_DEG = 1e-4  # exceeds TOUCH_M everywhere between the polar circles

# A line that passes the same support twice counts it once, at its first place. A vanished support keeps its place, as missions still refer
# to it. Objects without an OSM node (drawn, manually moved or from another file) are joined by position: a support to a vertex within
# TOUCH_M of it, as in network/build/joining.py. The first condition on the distance, in degrees, is the one that the index supports.
_NUMBER = f"""
WITH met AS (
    SELECT l.id AS line_id, s.id AS support_id, node.vertex
    FROM inspection_asset l
    CROSS JOIN LATERAL unnest(l.node_osm_ids) WITH ORDINALITY AS node(osm_id, vertex)
    JOIN inspection_asset s ON s.kind = 'tower' AND s.osm_type = 'n' AND s.osm_id = node.osm_id AND s.vanished_at IS NULL
    WHERE l.kind = 'line' AND l.is_flyable AND l.vanished_at IS NULL
  UNION ALL
    SELECT l.id, s.id, (point).path[1]
    FROM inspection_asset s
    JOIN inspection_asset l ON l.kind = 'line' AND l.is_flyable AND l.vanished_at IS NULL
      AND ST_DWithin(l.geometry, s.geometry, {REACH_DEG})
    CROSS JOIN LATERAL ST_DumpPoints(l.geometry) AS point
    WHERE s.kind = 'tower' AND s.vanished_at IS NULL AND (s.osm_id IS NULL OR s.is_edited)
      AND ST_DistanceSphere((point).geom, s.geometry) <= {TOUCH_M}
  UNION ALL
    SELECT l.id, s.id, (point).path[1]
    FROM inspection_asset l
    CROSS JOIN LATERAL ST_DumpPoints(l.geometry) AS point
    JOIN inspection_asset s ON s.kind = 'tower' AND s.vanished_at IS NULL AND ST_DWithin(s.geometry, (point).geom, {REACH_DEG})
    WHERE l.kind = 'line' AND l.is_flyable AND l.vanished_at IS NULL AND (l.osm_id IS NULL OR l.is_edited)
      AND COALESCE(l.node_osm_ids[(point).path[1]], {NO_OSM_NODE}) = {NO_OSM_NODE}
      AND ST_DistanceSphere((point).geom, s.geometry) <= {TOUCH_M}
), carried AS (
    SELECT met.line_id, l.max_voltage_v, met.support_id, min(met.vertex) AS vertex
    FROM met JOIN inspection_asset l ON l.id = met.line_id
    GROUP BY met.line_id, l.max_voltage_v, met.support_id
), numbered AS (
    SELECT line_id, max_voltage_v, support_id, row_number() OVER (PARTITION BY line_id ORDER BY vertex) AS place,
           count(*) OVER (PARTITION BY line_id) AS places
    FROM carried
), chosen AS (
    SELECT DISTINCT ON (support_id) support_id, line_id, place::smallint AS place, places::smallint AS places
    FROM numbered ORDER BY support_id, max_voltage_v DESC NULLS LAST, line_id
)
UPDATE inspection_asset a
SET line_id = found.line_id, place_on_line = found.place, places_on_line = found.places
FROM (
    SELECT s.id, c.line_id, c.place, c.places
    FROM inspection_asset s LEFT JOIN chosen c ON c.support_id = s.id
    WHERE s.kind = 'tower' AND s.vanished_at IS NULL
) found
WHERE a.id = found.id AND (a.line_id, a.place_on_line, a.places_on_line) IS DISTINCT FROM (found.line_id, found.place, found.places)
"""  # noqa: S608 -- made of constants


def number_supports() -> int:
    """Update line, place and number of places of every support; returns how many rows changed.

    Call it in the transaction that changed supports or lines, under hold_ground. It writes only rows that differ, and neither their
    `updated_at` nor whether they count as edited.
    """
    with connection.cursor() as cursor:
        cursor.execute(_NUMBER)
        return int(cursor.rowcount)
