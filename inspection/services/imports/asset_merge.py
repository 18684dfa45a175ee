"""Stages the rows of a file, compares them with the assets of its source, and updates these to the file.

OpenStreetMap files and other asset files differ in which assets belong to them (`MergeSource`); the rest is the same. A row that a curator
edited is changed only if it is to be replaced: the file's version is stored beside it, as source_facts. Assets of the source that are
missing from the file are marked as vanished, never deleted.
"""

# ruff: noqa: S608 -- the statements are made of the constants of this package

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from django.db import connection
from django.db.backends.utils import CursorWrapper

from inspection.models import ROW_ACTIONS, ChangeAction
from inspection.services.facts import ASSET_FACTS
from workspace.models import DEFAULT_ORGANISATION_ID, User

MANY_NEW = 10_000  # rows after which the database's planner statistics are outdated
UNCHANGED = "unchanged"
_KEYS = ("kind", "osm_type", "osm_id", "source_key")
_VALUES = (
    "subtype", "geometry", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "circuits", "height_m", "length_m",
    "is_flyable", "node_osm_ids", "tags", "parts", "content_hash",
)  # fmt: skip
COLUMNS = (*_KEYS, *_VALUES, "external_id")  # of a staged row
_STAGING = """
CREATE TEMPORARY TABLE asset_staging (
    id serial, kind text, osm_type text, osm_id bigint, source_key text, subtype text, geometry geometry, centre geometry, name text,
    ref text, operator text, voltages_v integer[], max_voltage_v integer, circuits smallint, height_m double precision,
    length_m double precision, is_flyable boolean, node_osm_ids bigint[], tags jsonb, parts jsonb, content_hash text, external_id text
) ON COMMIT DROP
"""
_COPY = f"COPY asset_staging ({', '.join(COLUMNS)}) FROM STDIN"
_JOINED = ", ".join(("id", *_KEYS))
_DIFFERS = "a.content_hash <> s.content_hash"
_FATE = "FROM asset_fate f JOIN asset_staging s ON s.id = f.staging_id JOIN inspection_asset a ON a.id = f.asset_id"
_LABEL = (
    "COALESCE(NULLIF({row}.ref, ''), NULLIF({row}.name, ''), "
    "INITCAP({row}.kind) || ' ' || COALESCE({row}.osm_type || {row}.osm_id, {row}.source_key))"
)
_KEY = "COALESCE(s.kind || ' ' || COALESCE(s.osm_type || s.osm_id, '') || ' ' || s.source_key, 'asset ' || f.asset_id)"
_EXCLUDED = f"""
DELETE FROM asset_fate WHERE ctid IN (
    SELECT f.ctid FROM asset_fate f LEFT JOIN asset_staging s ON s.id = f.staging_id WHERE {_KEY} = ANY(%(excluded)s))
"""
_WITHOUT_FATE = "DELETE FROM asset_staging s WHERE NOT EXISTS (SELECT FROM asset_fate f WHERE f.staging_id = s.id)"
_BY_KIND = """
SELECT COALESCE(a.kind, s.kind), f.fate, count(*)
FROM asset_fate f LEFT JOIN asset_staging s ON s.id = f.staging_id LEFT JOIN inspection_asset a ON a.id = f.asset_id GROUP BY 1, 2
"""
_ENTRY = "INSERT INTO workspace_auditentry (organisation_id, actor_id, action, subject_type, subject_id, before, after)"


@dataclass(frozen=True)
class Sample:
    """A row that a file would change: as stored, as in the file, or both; facts as JSON."""

    kind: str
    asset_id: int | None
    label: str | None
    label_in_file: str | None
    geometry: bytes | None  # WKB
    geometry_in_file: bytes | None
    facts: str | None
    facts_in_file: str | None
    key: str  # names the row in this difference, however often the file is read


@dataclass(frozen=True)
class MergeSource:
    """The assets of a source, as SQL over a (an asset) and s (a staged row), with the values of `Merge`."""

    same: str
    missing: str  # assets that count as vanished, or as edited and vanished, where the file has no matching one
    newer: str = "false"  # assets for which the file's data are older than the stored ones
    facts: tuple[str, ...] = ()  # facts in the history beside those that users read
    order: str = "f.staging_id, f.asset_id"  # of samples
    # An edited asset follows its source again once the source states the curator's values. Not with OpenStreetMap, where others edit: a
    # curator's decision stays.
    follows_again: bool = False

    @cached_property
    def fates(self) -> str:
        """Return SQL for the outcome of each row of the file and of each missing one of the source."""
        return f"""
CREATE TEMPORARY TABLE asset_fate ON COMMIT DROP AS
SELECT a.id AS asset_id, s.id AS staging_id, COALESCE(a.is_edited, false) AS is_edited,
       CASE WHEN a.id IS NULL THEN 'new'
            WHEN a.is_edited AND NOT %(replace_edited)s THEN CASE WHEN {_DIFFERS} THEN 'kept' ELSE 'unchanged' END
            WHEN {self.newer} THEN 'newer'
            WHEN a.is_edited OR a.vanished_at IS NOT NULL OR {_DIFFERS} THEN 'changed'
            ELSE 'unchanged' END AS fate
FROM asset_staging s LEFT JOIN inspection_asset a ON {self.same}
UNION ALL
SELECT a.id, NULL, a.is_edited,
       CASE WHEN NOT a.is_edited OR %(replace_edited)s THEN 'vanished'
            WHEN COALESCE((a.source_facts->>'vanished')::boolean, false) THEN 'unchanged' ELSE 'kept' END
FROM inspection_asset a
WHERE {self.missing} AND (a.vanished_at IS NULL OR a.is_edited AND NOT %(replace_edited)s)
  AND NOT EXISTS (SELECT FROM asset_staging s WHERE {self.same})
"""

    def facts_of(self, row: str, *, vanished: str = "false", **instead: str) -> str:
        """Return SQL for the facts of services/facts.py, of the row with this alias; some members from elsewhere."""
        members = ", ".join(f"'{column}', {instead.get(column, f'{row}.{column}')}" for column in (*ASSET_FACTS, *self.facts))
        return f"jsonb_build_object({members}, 'geometry', ST_AsGeoJSON({row}.geometry, 15)::jsonb, 'vanished', {vanished})"

    @cached_property
    def stored_facts(self) -> str:
        return self.facts_of("a", vanished="a.vanished_at IS NOT NULL")

    @cached_property
    def facts_in_file(self) -> str:
        return self.facts_of("s", asset_set_id="%(asset_set)s::bigint", data_import_id="%(data_import)s::bigint", is_edited="false")

    @cached_property
    def samples(self) -> str:
        """Return SQL for samples: kind, asset and label, then label, geometry and facts of both sides, the stored one first."""
        return f"""
SELECT COALESCE(a.kind, s.kind), a.id, {_LABEL.format(row="a")}, {_LABEL.format(row="s")}, ST_AsBinary(a.geometry), ST_AsBinary(s.geometry),
       CASE WHEN a.id IS NOT NULL THEN {self.stored_facts} END::text, CASE WHEN s.id IS NOT NULL THEN {self.facts_in_file} END::text,
       {_KEY}
FROM asset_fate f LEFT JOIN asset_staging s ON s.id = f.staging_id LEFT JOIN inspection_asset a ON a.id = f.asset_id
WHERE f.fate = %(fate)s ORDER BY {self.order} LIMIT %(most)s
"""

    @cached_property
    def changes(self) -> tuple[str, ...]:
        """Return the statements that update assets, except new ones, to the file, ordered so that the history has the former state."""
        after = self.facts_of("a", vanished="true", data_import_id="%(data_import)s::bigint", is_edited="false")
        return (
            f"""{_ENTRY}
SELECT %(organisation)s, %(actor)s, 'changed', 'asset', a.id::text, {self.stored_facts}, {self.facts_in_file}
{_FATE} WHERE f.fate = 'changed' ORDER BY a.id""",
            f"""{_ENTRY}
SELECT %(organisation)s, %(actor)s, 'vanished', 'asset', a.id::text, {self.stored_facts}, {after}
FROM asset_fate f JOIN inspection_asset a ON a.id = f.asset_id WHERE f.fate = 'vanished' ORDER BY a.id""",
            """
UPDATE inspection_asset a
SET vanished_at = now(), data_import_id = %(data_import)s, is_edited = false, source_facts = NULL, revision = a.revision + 1,
    updated_at = now()
FROM asset_fate f WHERE f.asset_id = a.id AND f.fate = 'vanished'""",
            f"""
UPDATE inspection_asset a
SET {", ".join(f"{column} = s.{column}" for column in _VALUES)}, data_import_id = %(data_import)s, vanished_at = NULL,
    is_edited = false, source_facts = NULL, revision = a.revision + 1, updated_at = now()
FROM asset_fate f JOIN asset_staging s ON s.id = f.staging_id WHERE f.asset_id = a.id AND f.fate = 'changed'""",
        )

    @cached_property
    def kept(self) -> tuple[str, ...]:
        """Return the statements for edited rows, which stay as they are and store their source's current facts."""
        same, in_file = "false", self.facts_of("s", asset_set_id="NULL", data_import_id="NULL", is_edited="false")
        if self.follows_again:
            facts = " AND ".join(f"a.{column} IS NOT DISTINCT FROM s.{column}" for column in ASSET_FACTS)
            same = f"(a.vanished_at IS NULL AND ST_AsBinary(a.geometry) = ST_AsBinary(s.geometry) AND {facts})"
        return (
            f"""
UPDATE inspection_asset a
SET content_hash = s.content_hash, is_edited = NOT {same}, source_facts = CASE WHEN NOT {same} THEN {in_file} END
FROM asset_fate f JOIN asset_staging s ON s.id = f.staging_id WHERE f.asset_id = a.id AND f.fate = 'kept'""",
            f"""
UPDATE inspection_asset a
SET source_facts = COALESCE(a.source_facts, {self.stored_facts}) || '{{"vanished": true}}'
FROM asset_fate f WHERE f.asset_id = a.id AND f.fate = 'kept' AND f.staging_id IS NULL""",
        )


_NEW = ", ".join((*_KEYS, *_VALUES))
_INSERT = f"""
INSERT INTO inspection_asset ({_NEW}, asset_set_id, data_import_id, is_edited, updated_at)
SELECT {", ".join(f"s.{column}" for column in (*_KEYS, *_VALUES))}, %(asset_set)s::bigint, %(data_import)s, false, now()
FROM asset_staging s JOIN asset_fate f ON f.staging_id = s.id
WHERE f.fate = 'new' ORDER BY s.kind DESC, s.osm_id, s.id
"""


class Merge:
    """A staged file and its source: the changes of the file, and their execution. Valid in the transaction that staged it."""

    def __init__(
        self,
        cursor: CursorWrapper,
        source: MergeSource,
        *,
        replace_edited: bool,
        asset_set: int | None = None,
        excluded: Sequence[str] = (),
        **values: Any,
    ) -> None:
        """excluded: keys of rows of the difference that stay as they are, see Sample."""
        self._cursor, self._source = cursor, source
        self._values = {"replace_edited": replace_edited, "asset_set": asset_set, "data_import": None} | values
        cursor.execute(f"ANALYZE asset_staging ({_JOINED}), inspection_asset ({_JOINED})")  # or statistics show it empty after an import
        cursor.execute(source.fates, self._values)
        if excluded:
            cursor.execute(_EXCLUDED, {"excluded": list(excluded)})
            cursor.execute(_WITHOUT_FATE)  # what follows the merge reads the staged rows too
        cursor.execute("ANALYZE asset_fate")
        cursor.execute("SELECT fate, count(*), count(*) FILTER (WHERE is_edited AND staging_id IS NOT NULL) FROM asset_fate GROUP BY fate")
        found = {fate: (number, edited) for fate, number, edited in cursor.fetchall()}
        self.numbers = {str(fate): found.get(fate, (0, 0))[0] for fate in (*ROW_ACTIONS, UNCHANGED)}
        self.newer = found.get("newer", (0, 0))[0]
        self.edited = {fate: edited for fate, (_, edited) in found.items()}  # rows of the file whose asset is edited

    @property
    def changes_something(self) -> bool:
        return any(self.numbers[action] for action in (ChangeAction.NEW, ChangeAction.CHANGED, ChangeAction.VANISHED))

    def samples(self, action: ChangeAction, most: int) -> list[Sample]:
        """Return the first rows of this action."""
        self._cursor.execute(self._source.samples, self._values | {"fate": action.value, "most": most})
        return [Sample(*row) for row in self._cursor.fetchall()]

    def by_kind(self) -> dict[str, dict[str, int]]:
        """Return the numbers of `numbers`, of each kind of asset. Rows with older data in the file count as unchanged."""
        self._cursor.execute(_BY_KIND)
        found: dict[str, dict[str, int]] = {}
        for kind, fate, number in self._cursor.fetchall():
            counted = found.setdefault(kind, dict.fromkeys(self.numbers, 0))
            counted[fate if fate in counted else UNCHANGED] += number
        return found

    def missing(self, **values: Any) -> dict[str, int]:
        """Return by kind how many assets the file would remove with other values of the source, beside those that it removes anyway."""
        self._cursor.execute(
            f"""
SELECT a.kind, count(*) FROM inspection_asset a
WHERE {self._source.missing} AND a.vanished_at IS NULL
  AND NOT EXISTS (SELECT FROM asset_staging s WHERE {self._source.same})
  AND NOT EXISTS (SELECT FROM asset_fate f WHERE f.asset_id = a.id AND f.fate = 'vanished') GROUP BY 1""",
            self._values | values,
        )
        return dict(self._cursor.fetchall())

    def write(self, data_import: int, actor: User | None, notify: Callable[[float], None] = lambda share: None) -> None:
        """Update the assets to the file. notify is called with the share done, 0 to 1."""
        self._values |= {
            "data_import": data_import, "actor": actor and actor.pk,
            "organisation": actor.organisation_id if actor else DEFAULT_ORGANISATION_ID,
        }  # fmt: skip
        for statement in self._source.changes:
            self._cursor.execute(statement, self._values)
        self.keep_beside()
        notify(0.25)
        self._cursor.execute(_INSERT, self._values)
        notify(0.75)
        columns = "" if self.numbers[ChangeAction.NEW] > MANY_NEW else "(id, kind, osm_type, osm_id, line_id, vanished_at)"
        self._cursor.execute(f"ANALYZE inspection_asset {columns}")  # numbering of supports and tiles follow soon

    def keep_beside(self) -> None:
        for statement in self._source.kept:
            self._cursor.execute(statement, self._values)


@contextmanager
def staging() -> Iterator[tuple[CursorWrapper, Callable[[], Any]]]:
    """Yield a cursor on an empty staging table, and a context for writing its rows. Call it in a transaction."""
    with connection.cursor() as cursor:
        cursor.execute(_STAGING)
        yield cursor, lambda: cursor.copy(_COPY)
        # Before the end of the transaction, as several imports may share one.
        cursor.execute("DROP TABLE IF EXISTS asset_fate")
        cursor.execute("DROP TABLE asset_staging")
