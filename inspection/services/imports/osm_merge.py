"""The statements that compare staged OSM records with the assets, and that make the assets what they say.

A row that a curator edited is not touched unless it is to be replaced: what the file says of it is kept beside it (source_facts). A row
that a file with newer data has written is not touched either.
"""

# ruff: noqa: S608 -- the statements are put together from the constants of this file alone

_FACT_COLUMNS = (
    "kind", "subtype", "name", "ref", "operator", "voltages_v", "circuits", "height_m", "is_flyable", "tags", "osm_type", "osm_id",
    "node_osm_ids", "parts", "content_hash",
)  # fmt: skip
COLUMNS = (
    "kind", "subtype", "osm_type", "osm_id", "geometry", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits",
    "height_m", "length_m", "is_flyable", "node_osm_ids", "tags", "parts", "content_hash",
)  # fmt: skip

STAGING = """
CREATE TEMPORARY TABLE osm_staging (
    kind text, subtype text, osm_type text, osm_id bigint, geometry geometry, centre geometry, name text, ref text, operator text,
    voltages_v integer[], max_voltage_v integer, circuits smallint, height_m double precision, length_m double precision,
    is_flyable boolean, node_osm_ids bigint[], tags jsonb, parts jsonb, content_hash text
) ON COMMIT DROP
"""
COPY = f"COPY osm_staging ({', '.join(COLUMNS)}) FROM STDIN"
# Of an object that stands twice in a file the last one counts.
KEEP_THE_LAST = """
DELETE FROM osm_staging s USING (
    SELECT kind, osm_type, osm_id, max(ctid) AS last FROM osm_staging GROUP BY kind, osm_type, osm_id HAVING count(*) > 1
) twice
WHERE s.kind = twice.kind AND s.osm_type = twice.osm_type AND s.osm_id = twice.osm_id AND s.ctid <> twice.last
"""


def facts(row: str, vanished: str = "false") -> str:
    """What services/facts.py says of an asset, of the row with this alias."""
    members = ", ".join(f"'{column}', {row}.{column}" for column in _FACT_COLUMNS)
    return f"jsonb_build_object({members}, 'geometry', ST_AsGeoJSON({row}.geometry, 15)::jsonb, 'vanished', {vanished})"


_IS_NEWER = "EXISTS (SELECT FROM inspection_dataimport i WHERE i.id = a.data_import_id AND i.data_timestamp > %(timestamp)s)"
_SAME = "a.kind = s.kind AND a.osm_type = s.osm_type AND a.osm_id = s.osm_id"
_DIFFERS = "(a.content_hash <> s.content_hash OR a.vanished_at IS NOT NULL)"

# The row of the file takes the place of the asset's.
_TAKEN = f"""
{_SAME} AND (CASE WHEN a.is_edited THEN %(replace_edited)s ELSE {_DIFFERS} END) AND NOT {_IS_NEWER}
"""
_KEPT = f"{_SAME} AND a.is_edited AND NOT %(replace_edited)s AND a.content_hash <> s.content_hash"
_UNKNOWN = f"NOT EXISTS (SELECT FROM inspection_asset a WHERE {_SAME})"
_GONE = f"""
a.osm_id IS NOT NULL AND NOT a.is_edited AND a.vanished_at IS NULL
AND (a.data_import_id = ANY(%(sources)s) OR %(whole_region)s)
AND a.kind || ' ' || a.subtype <> ALL(%(filtered_out)s)
AND NOT EXISTS (SELECT FROM osm_staging s WHERE {_SAME})
AND NOT {_IS_NEWER}
AND (%(box)s::geometry IS NULL OR ST_Intersects(ST_Points(a.geometry), %(box)s::geometry))
"""

COUNTS = f"""
SELECT (SELECT count(*) FROM osm_staging s WHERE {_UNKNOWN}),
       (SELECT count(*) FROM inspection_asset a, osm_staging s WHERE {_TAKEN}),
       (SELECT count(*) FROM inspection_asset a WHERE {_GONE}),
       (SELECT count(*) FROM inspection_asset a, osm_staging s WHERE {_KEPT}),
       (SELECT count(*) FROM inspection_asset a, osm_staging s WHERE {_SAME} AND a.is_edited),
       (SELECT count(*) FROM inspection_asset a, osm_staging s WHERE {_SAME} AND NOT a.is_edited AND {_IS_NEWER}),
       (SELECT count(*) FROM inspection_asset a, osm_staging s WHERE {_SAME} AND NOT a.is_edited AND NOT {_IS_NEWER} AND NOT {_DIFFERS})
"""

_NAMED = "COALESCE(NULLIF({row}.ref, ''), NULLIF({row}.name, ''), INITCAP({row}.kind) || ' ' || {row}.osm_type || {row}.osm_id)"
_OF_THE_FILE, _OF_THE_ASSET = _NAMED.format(row="s"), _NAMED.format(row="a")
_WAS = facts("a", "a.vanished_at IS NOT NULL")
# Each gives kind, id of the asset, label, geometry, before, after.
SAMPLES = {
    "new": f"""SELECT s.kind, NULL::bigint, {_OF_THE_FILE}, ST_AsBinary(s.geometry), NULL::jsonb, {facts("s")}
               FROM osm_staging s WHERE {_UNKNOWN} ORDER BY s.kind, s.osm_id LIMIT %(most)s""",
    "changed": f"""SELECT a.kind, a.id, {_OF_THE_ASSET}, ST_AsBinary(s.geometry), {_WAS}, {facts("s")}
                   FROM inspection_asset a, osm_staging s WHERE {_TAKEN} ORDER BY a.id LIMIT %(most)s""",
    "vanished": f"""SELECT a.kind, a.id, {_OF_THE_ASSET}, ST_AsBinary(a.geometry), {_WAS}, NULL::jsonb
                    FROM inspection_asset a WHERE {_GONE} ORDER BY a.id LIMIT %(most)s""",
    "kept": f"""SELECT a.kind, a.id, {_OF_THE_ASSET}, ST_AsBinary(a.geometry), {_WAS}, {facts("s")}
                FROM inspection_asset a, osm_staging s WHERE {_KEPT} ORDER BY a.id LIMIT %(most)s""",
}  # fmt: skip

_ENTRY = "INSERT INTO workspace_auditentry (organisation_id, actor_id, action, subject_type, subject_id, before, after)"
REMEMBER_CHANGED = f"""{_ENTRY}
SELECT %(organisation)s, %(actor)s, 'changed', 'asset', a.id::text, {_WAS}, {facts("s")}
FROM inspection_asset a, osm_staging s WHERE {_TAKEN}
"""
REMEMBER_GONE = f"""{_ENTRY}
SELECT %(organisation)s, %(actor)s, 'vanished', 'asset', a.id::text, {_WAS}, {facts("a", "true")}
FROM inspection_asset a WHERE {_GONE}
"""
UPDATE = f"""
UPDATE inspection_asset a
SET subtype = s.subtype, geometry = s.geometry, centre = s.centre, name = s.name, ref = s.ref, operator = s.operator,
    voltages_v = s.voltages_v, max_voltage_v = s.max_voltage_v, circuits = s.circuits, height_m = s.height_m, length_m = s.length_m,
    is_flyable = s.is_flyable, node_osm_ids = s.node_osm_ids, tags = s.tags, parts = s.parts, content_hash = s.content_hash,
    data_import_id = %(data_import)s, vanished_at = NULL, updated_at = now(), revision = a.revision + 1, is_edited = false,
    source_facts = NULL
FROM osm_staging s
WHERE {_TAKEN}
"""
KEEP_BESIDE = f"""
UPDATE inspection_asset a SET content_hash = s.content_hash, source_facts = {facts("s")} FROM osm_staging s WHERE {_KEPT}
"""
INSERT = f"""
INSERT INTO inspection_asset ({", ".join(COLUMNS)}, data_import_id, is_edited, updated_at)
SELECT {", ".join(f"s.{column}" for column in COLUMNS)}, %(data_import)s, false, now()
FROM osm_staging s
WHERE {_UNKNOWN}
ORDER BY s.kind DESC, s.osm_id
"""
VANISH = f"""
UPDATE inspection_asset a
SET vanished_at = now(), updated_at = now(), data_import_id = %(data_import)s, revision = revision + 1
WHERE {_GONE}
"""
CHANGES_OF_ROWS = (REMEMBER_CHANGED, REMEMBER_GONE, VANISH, UPDATE, KEEP_BESIDE)  # in this order: the history is of what was
