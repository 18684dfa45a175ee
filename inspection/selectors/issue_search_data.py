"""Reads map data as the plain arrays in which issues are searched."""

from typing import Any

import numpy as np
from django.db import connection
from numpy.typing import NDArray

from inspection.models import AssetKind
from inspection.network.infrastructure import InfrastructurePlaces, InfrastructureWays
from inspection.quality.infrastructure import NO_OSM_ID, IssueSearchData, PlainBridge, SupportFacts, WayFacts, asset_key
from inspection.selectors.ground_data import ground_data

_WAYS = """
SELECT id, osm_id, subtype, voltages_v, coalesce(tags ->> 'voltage', ''), is_edited
FROM inspection_asset WHERE kind = %s AND is_flyable AND vanished_at IS NULL ORDER BY id
"""
# Packed into two byte strings: a million supports are a few megabytes instead of a million rows.
_SUPPORTS = """
SELECT coalesce(string_agg(int8send(id), ''::bytea ORDER BY id), ''::bytea),
       coalesce(string_agg(int8send(coalesce(osm_id, -1)), ''::bytea ORDER BY id), ''::bytea)
FROM inspection_asset WHERE kind = 'tower' AND is_flyable AND vanished_at IS NULL
"""
# https://wiki.openstreetmap.org/wiki/Tag:power=tower: portals are in substations, a terminal or transition tower ends an overhead line.
_TERMINALS = """
SELECT coalesce(string_agg(int8send(id), ''::bytea ORDER BY id), ''::bytea)
FROM inspection_asset
WHERE kind = 'tower' AND is_flyable AND vanished_at IS NULL
  AND (subtype = 'portal' OR tags ->> 'location:transition' = 'yes' OR tags ->> 'tower:type' IN ('termination', 'transition', 'portal')
       OR tags ->> 'line_management' IN ('termination', 'transition')
       OR tags ->> 'design' = 'portal')
"""
_OFF_NETWORK = """
SELECT ST_X(p.geom), ST_Y(p.geom)
FROM inspection_asset a CROSS JOIN LATERAL ST_DumpPoints(a.geometry) p
WHERE a.kind = 'line' AND NOT a.is_flyable AND a.vanished_at IS NULL
"""
_BRIDGES = """
SELECT id, osm_type, osm_id, ST_X(centre), ST_Y(centre)
FROM inspection_asset WHERE kind = 'bridge' AND carries = '' AND is_flyable AND vanished_at IS NULL ORDER BY id
"""


def issue_search_data() -> IssueSearchData:
    """Return the map data of the named revision, or slightly newer."""
    data = ground_data()
    with connection.cursor() as cursor:
        cursor.execute(_SUPPORTS)
        support_id, support_osm = (np.frombuffer(bytes(column), dtype=">i8").astype(np.int64) for column in cursor.fetchone())
        cursor.execute(_TERMINALS)
        terminal = np.frombuffer(bytes(cursor.fetchone()[0]), dtype=">i8").astype(np.int64)
        cursor.execute(_OFF_NETWORK)
        off_network = np.array(cursor.fetchall(), dtype=np.float64).reshape(-1, 2)
        cursor.execute(_BRIDGES)
        bridges = tuple(
            PlainBridge(pk, asset_key(osm_type or "a", NO_OSM_ID if osm_id is None else osm_id, pk), (lon, lat))
            for pk, osm_type, osm_id, lon, lat in cursor.fetchall()
        )
    return IssueSearchData(
        revision=data.revision,
        lines=data.lines,
        line_facts=_way_facts(AssetKind.LINE, data.lines),
        railways=data.railways,
        railway_facts=_way_facts(AssetKind.RAILWAY, data.railways),
        supports=data.supports,
        support_facts=_support_facts(data.supports, support_id, support_osm, terminal),
        bridges_without_way=bridges,
        off_network=off_network,
    )


def _way_facts(kind: AssetKind, ways: InfrastructureWays) -> WayFacts:
    with connection.cursor() as cursor:
        cursor.execute(_WAYS, [kind.value])
        rows = {row[0]: row[1:] for row in cursor.fetchall()}
    nothing: tuple[Any, ...] = (None, "", [], "", False)  # a line deleted since the arrays were read
    found = [rows.get(pk, nothing) for pk in ways.asset.tolist()]
    return WayFacts(
        osm_id=np.array([NO_OSM_ID if row[0] is None else row[0] for row in found], dtype=np.int64),
        subtype=tuple(row[1] for row in found),
        voltages_v=tuple(tuple(sorted(row[2], reverse=True)) for row in found),
        voltage_text=tuple(row[3] for row in found),
        is_edited=np.array([row[4] for row in found], dtype=bool),
    )


def _support_facts(
    supports: InfrastructurePlaces, asset: NDArray[np.int64], osm_id: NDArray[np.int64], terminal: NDArray[np.int64]
) -> SupportFacts:
    slot = np.searchsorted(asset, supports.asset)
    found = slot < len(asset)
    found[found] = asset[slot[found]] == supports.asset[found]
    osm = np.full(len(supports), NO_OSM_ID, dtype=np.int64)
    osm[found] = osm_id[slot[found]]
    return SupportFacts(osm_id=osm, is_terminal=np.isin(supports.asset, terminal))
