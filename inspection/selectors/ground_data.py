"""Reads assets and zones as the plain arrays from which the graph is built."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from django.db import connection

from inspection.models import AssetKind
from inspection.network.infrastructure import NO_OSM_NODE, BridgeOutlines, GroundData, InfrastructurePlaces, InfrastructureWays, Zones
from inspection.network.rules import HIGHEST_VOLTAGE_HEIGHT_M, HIGHEST_VOLTAGE_V
from inspection.scene.bridges import tall_share
from inspection.selectors.ground import ground_revision

READINGS = 3


@dataclass(frozen=True)
class _Area:
    """A further SQL condition, written in this file, with its parameters."""

    condition: str = ""
    parameters: list[Any] = field(default_factory=list)


EVERYWHERE = _Area()


def has_flyable_assets() -> bool:
    return bool(_rows("SELECT EXISTS (SELECT 1 FROM inspection_asset WHERE is_flyable AND vanished_at IS NULL)")[0][0])


def ground_data() -> GroundData:
    """Return all flyable assets that have not vanished, and all zones.

    Reads again when the map data change meanwhile; under constant changes the data are at least as new as the named revision.
    """
    for _ in range(READINGS):
        revision = ground_revision()
        bridges, outlines = _bridges()
        data = GroundData(
            revision=revision,
            supports=_supports(),
            bridges=bridges,
            lines=_ways(AssetKind.LINE),
            railways=_ways(AssetKind.RAILWAY),
            zones=zones_of_the_ground(),
            bridge_outlines=outlines,
        )
        if ground_revision() == revision:
            break
    return data


def supports_and_lines(
    box: tuple[float, float, float, float], *, line: int | None = None
) -> tuple[InfrastructurePlaces, InfrastructureWays]:
    """Return flyable supports and lines whose box meets west, south, east, north; only one line, if it is named."""
    in_box = _Area("AND geometry && ST_MakeEnvelope(%s, %s, %s, %s, 4326)", list(box))
    lines = in_box if line is None else _Area("AND id = %s", [line])
    return _supports(in_box), _ways(AssetKind.LINE, lines)


def zones_of_the_ground() -> Zones:
    rows = _rows("SELECT id, name, ST_AsBinary(geometry) FROM inspection_noflyzone ORDER BY id")
    return Zones(
        tuple(bytes(wkb) for _, _, wkb in rows), np.array([pk for pk, _, _ in rows], dtype=np.int64), tuple(name for _, name, _ in rows)
    )


def _rows(statement: str, parameters: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
    with connection.cursor() as cursor:
        cursor.execute(statement, parameters)
        return cursor.fetchall()


def _supports(area: _Area = EVERYWHERE) -> InfrastructurePlaces:
    rows = _rows(
        f"""
        SELECT id, CASE WHEN osm_type = 'n' AND NOT is_edited THEN osm_id END, ST_X(geometry), ST_Y(geometry), height_m
        FROM inspection_asset WHERE kind = %s AND is_flyable AND vanished_at IS NULL {area.condition} ORDER BY id
        """,  # noqa: S608  # the condition is a literal of this file
        [AssetKind.TOWER, *area.parameters],
    )
    return InfrastructurePlaces(
        asset=np.array([row[0] for row in rows], dtype=np.int64),
        osm_node=np.array([NO_OSM_NODE if row[1] is None else row[1] for row in rows], dtype=np.int64),
        position=np.array([row[2:4] for row in rows], dtype=np.float64).reshape(-1, 2),
        height_m=np.array([np.nan if row[4] is None else row[4] for row in rows], dtype=np.float64),
    )


def _bridges() -> tuple[InfrastructurePlaces, BridgeOutlines]:
    """Return the bridges by their centres, and their outlines in the same order, as of one moment."""
    rows = _rows(
        """
        SELECT id, ST_X(centre), ST_Y(centre), height_m, ST_AsBinary(geometry), tags, jsonb_path_query_array(parts, '$[*].tags')
        FROM inspection_asset WHERE kind = %s AND is_flyable AND vanished_at IS NULL ORDER BY id
        """,
        [AssetKind.BRIDGE],
    )
    places = InfrastructurePlaces(
        asset=np.array([row[0] for row in rows], dtype=np.int64),
        osm_node=np.full(len(rows), NO_OSM_NODE, dtype=np.int64),
        position=np.array([row[1:3] for row in rows], dtype=np.float64).reshape(-1, 2),
        height_m=np.array([np.nan if row[3] is None else row[3] for row in rows], dtype=np.float64),
    )
    areas = shapely.from_wkb(np.array([bytes(row[4]) for row in rows], dtype=object))
    shares = [tall_share([json.loads(row[5]), *json.loads(row[6])]) for row in rows]
    return places, BridgeOutlines(np.asarray(areas, dtype=object).reshape(-1), np.array(shares, dtype=np.float64))


def _ways(kind: AssetKind, area: _Area = EVERYWHERE) -> InfrastructureWays:
    """Return ways. One whose vertices do not match its list of OSM nodes, or that a curator edited, is joined by position only."""
    rows = _rows(
        f"""
        SELECT id, COALESCE(height_m, CASE WHEN max_voltage_v >= %s THEN %s END), ST_AsBinary(geometry),
               CASE WHEN NOT is_edited THEN node_osm_ids END
        FROM inspection_asset WHERE kind = %s AND is_flyable AND vanished_at IS NULL {area.condition} ORDER BY id
        """,  # noqa: S608  # the condition is a literal of this file
        [HIGHEST_VOLTAGE_V, HIGHEST_VOLTAGE_HEIGHT_M, kind, *area.parameters],
    )
    geometries = shapely.from_wkb(np.array([bytes(row[2]) for row in rows], dtype=object))
    parts, owner = shapely.get_parts(geometries, return_index=True)
    count = shapely.get_num_coordinates(parts)
    osm_nodes = [np.asarray(rows[row][3] or [], dtype=np.int64) for row in owner.tolist()]
    osm_nodes = [
        nodes if len(nodes) == vertices else np.full(vertices, NO_OSM_NODE)
        for nodes, vertices in zip(osm_nodes, count.tolist(), strict=True)
    ]
    asset = np.array([row[0] for row in rows], dtype=np.int64)
    height_m = np.array([np.nan if row[1] is None else row[1] for row in rows], dtype=np.float64)
    return InfrastructureWays(
        asset=asset[owner],
        height_m=height_m[owner],
        first=np.concatenate([[0], np.cumsum(count)]).astype(np.int64),
        osm_node=np.concatenate([np.zeros(0, dtype=np.int64), *osm_nodes]),
        position=shapely.get_coordinates(parts),
    )
