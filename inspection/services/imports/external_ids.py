"""Gives assets the external ids that a column of their file has for them: those of the organisation whose file it is.

A file's staged rows are in asset_staging (assets.py). An id goes with the file: it is taken from another asset of the set, and from
one that has vanished, but from no other. An empty cell leaves the id that an asset has.
"""

from django.db import connection

from inspection.geodesy.geometry_validator import GeometryFault
from inspection.importers.rows import AssetFileError

MAX_REPORTED = 50
_OF_THE_SET = "a.asset_set_id = %(asset_set)s AND a.kind = s.kind AND a.source_key = s.source_key"
_REFERENCE = "r.asset_id = a.id AND r.organisation_id = %(organisation)s"
_TAKEN = """
SELECT s.external_id
FROM asset_staging s
JOIN inspection_assetreference r ON r.organisation_id = %(organisation)s AND r.external_id = s.external_id
JOIN inspection_asset a ON a.id = r.asset_id
WHERE s.external_id <> '' AND a.vanished_at IS NULL AND a.asset_set_id IS DISTINCT FROM %(asset_set)s
ORDER BY s.id LIMIT %(most)s
"""
_NUMBER = f"""
SELECT count(*)
FROM asset_staging s LEFT JOIN inspection_asset a ON {_OF_THE_SET} LEFT JOIN inspection_assetreference r ON {_REFERENCE}
WHERE s.external_id <> '' AND s.external_id IS DISTINCT FROM r.external_id
"""  # noqa: S608 -- texts of this file alone
# Each asset that gets an id or loses one: what its organisation keeps with it, before and after.
_IDS = f"""
CREATE TEMPORARY TABLE asset_id_given ON COMMIT DROP AS
WITH given AS (SELECT a.id, s.external_id FROM asset_staging s JOIN inspection_asset a ON {_OF_THE_SET} WHERE s.external_id <> '')
SELECT given.id AS asset_id, r.external_id AS before, given.external_id AS after, COALESCE(r.attributes, '{{}}') AS attributes
FROM given LEFT JOIN inspection_assetreference r ON r.asset_id = given.id AND r.organisation_id = %(organisation)s
WHERE r.external_id IS DISTINCT FROM given.external_id
UNION ALL
SELECT r.asset_id, r.external_id, '', r.attributes
FROM inspection_assetreference r JOIN given ON given.external_id = r.external_id AND given.id <> r.asset_id
WHERE r.organisation_id = %(organisation)s AND r.asset_id NOT IN (SELECT id FROM given)
"""  # noqa: S608
_STATEMENTS = (
    """UPDATE inspection_assetreference r SET external_id = '', updated_at = now()
       FROM asset_id_given g WHERE r.asset_id = g.asset_id AND r.organisation_id = %(organisation)s""",
    """INSERT INTO inspection_assetreference (organisation_id, asset_id, external_id, attributes)
       SELECT %(organisation)s, asset_id, after, attributes FROM asset_id_given WHERE after <> ''
       ON CONFLICT (organisation_id, asset_id) DO UPDATE SET external_id = excluded.external_id""",
    """UPDATE inspection_asset a SET revision = a.revision + 1, updated_at = now() FROM asset_id_given g WHERE a.id = g.asset_id""",
    """INSERT INTO workspace_auditentry (organisation_id, actor_id, action, subject_type, subject_id, before, after)
       SELECT %(organisation)s, %(actor)s, 'changed', 'asset_reference', asset_id::text,
              jsonb_build_object('external_id', COALESCE(before, ''), 'attributes', attributes),
              jsonb_build_object('external_id', after, 'attributes', attributes)
       FROM asset_id_given""",
    "DROP TABLE asset_id_given",
)


def count_of_ids(asset_set: int | None, organisation: int) -> int:
    """How many ids the staged rows would give. Raises AssetFileError for those that an asset outside the set has."""
    values = {"asset_set": asset_set, "organisation": organisation, "most": MAX_REPORTED}
    with connection.cursor() as cursor:
        cursor.execute(_TAKEN, values)
        taken = [GeometryFault("columns.external_id", f"the external id {key[:60]!r} is another asset's") for (key,) in cursor.fetchall()]
        if taken:
            raise AssetFileError(taken)
        cursor.execute(_NUMBER, values)
        return int(cursor.fetchone()[0])


def give_ids(asset_set: int, organisation: int, actor: int | None) -> None:
    """Store them, once the rows are assets; in the transaction that staged them."""
    values = {"asset_set": asset_set, "organisation": organisation, "actor": actor}
    with connection.cursor() as cursor:
        for statement in (_IDS, *_STATEMENTS):
            cursor.execute(statement, values)
