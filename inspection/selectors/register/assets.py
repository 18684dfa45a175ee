"""The register of assets: what filters, sorts and counts them.

The voltage and the operator of a support are its own ones or, where these are not stated, those of its line.
"""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import lru_cache
from typing import Any

from django.db.models import (
    Case,
    Count,
    DateTimeField,
    Exists,
    F,
    FloatField,
    IntegerField,
    Max,
    OuterRef,
    Q,
    QuerySet,
    Subquery,
    Value,
    When,
)
from django.db.models.functions import Coalesce, NullIf, Upper

from inspection.hooks import inspected_shares_of, inspections_of
from inspection.models import Asset, AssetKind
from inspection.models.assets import LAST_NAME
from inspection.selectors.assets import Box, DrawnAsset, assets_on_the_ground, with_external_id
from inspection.selectors.ground import DatasetVersion, ground_dataset_version
from inspection.selectors.picking import supports_of_line

NEVER = datetime(1, 1, 2, tzinfo=UTC)  # sorts before every inspection
LONG_KINDS = (AssetKind.LINE, AssetKind.RAILWAY)
MAX_OPERATORS = 200
OPERATOR = Case(When(operator="", then=Coalesce("line__operator", Value(""))), default=F("operator"))


@dataclass(frozen=True)
class AssetFilter:
    """None or empty: any. `line` means the supports of a line, `region` assets that imports brought into it."""

    organisation_id: int
    box: Box | None = None
    kinds: tuple[AssetKind, ...] = ()
    text: str = ""
    flyable: bool | None = None
    external_id: str = ""
    voltages_v: tuple[int, ...] = ()
    operator: str = ""
    line: int | None = None
    region: int | None = None
    inspected: bool | None = None
    inspected_from: datetime | None = None
    inspected_before: datetime | None = None


@dataclass(frozen=True)
class AssetCounts:
    """Numbers of assets. Those of a fact disregard the filter by this fact, so that another value can be chosen."""

    total: int
    kinds: dict[str, int]
    voltages_v: list[tuple[int, int]]  # highest first
    operators: list[tuple[str, int]]  # most first, MAX_OPERATORS at most


def assets_that_match(wanted: AssetFilter) -> QuerySet[DrawnAsset]:
    """Return assets with their geometry as GeoJSON text in `geometry_json`, their line and their import."""
    assets = assets_on_the_ground(box=wanted.box, kinds=list(wanted.kinds), text=wanted.text, flyable=wanted.flyable)
    assets = assets.select_related("line", "data_import")
    if wanted.external_id:
        assets = with_external_id(assets, wanted.organisation_id, wanted.external_id)
    if wanted.voltages_v:
        stated = list(wanted.voltages_v)
        assets = assets.filter(Q(voltages_v__overlap=stated) | Q(voltages_v=[], line__voltages_v__overlap=stated))
    if wanted.operator:
        assets = assets.filter(Q(operator=wanted.operator) | Q(operator="", line__operator=wanted.operator))
    if wanted.line is not None:
        line = Asset.objects.filter(pk=wanted.line, kind=AssetKind.LINE).first()
        assets = assets.filter(pk__in=supports_of_line(line) if line is not None else [])
    if wanted.region is not None:
        assets = assets.filter(data_import__region=wanted.region)
    return _inspected(assets, wanted)


def _inspected(assets: QuerySet[DrawnAsset], wanted: AssetFilter) -> QuerySet[DrawnAsset]:
    rows = inspections_of(wanted.organisation_id).filter(asset=OuterRef("pk"))
    if wanted.inspected is not None:
        assets = assets.filter(Exists(rows) if wanted.inspected else ~Exists(rows))
    if wanted.inspected_from is not None:
        assets = assets.filter(Exists(rows.filter(inspected_at__gte=wanted.inspected_from)))
    if wanted.inspected_before is not None:
        assets = assets.filter(Exists(rows), ~Exists(rows.filter(inspected_at__gte=wanted.inspected_before)))
    return assets


@dataclass(frozen=True)
class LastInspection:
    """When an asset was inspected last: of a line or railway any part of it. `share` is of its length, ever inspected; None of others."""

    at: datetime
    share: float | None = None


def last_inspections(organisation_id: int, assets: Collection[int]) -> dict[int, LastInspection]:
    """Return the last inspection of those of these assets that were ever inspected, by key."""
    rows = inspections_of(organisation_id).filter(asset__in=assets).order_by()
    found = rows.values_list("asset", "asset__kind").annotate(last=Max("inspected_at"))
    shares = inspected_shares_of(organisation_id, [key for key, kind, _last in found if kind in LONG_KINDS])
    return {key: LastInspection(last, shares.get(key)) for key, _kind, last in found}


def _last_inspection(organisation_id: int) -> Case:
    """Return when an asset was inspected last, else NEVER; only of inspected ones each is looked up."""
    rows = inspections_of(organisation_id).order_by()
    last = rows.filter(asset=OuterRef("pk")).values("asset").annotate(last=Max("inspected_at")).values("last")
    return Case(When(pk__in=rows.values("asset"), then=Subquery(last)), default=Value(NEVER), output_field=DateTimeField())


_NOTHING = Value("")
_ORDERS: dict[str, Any] = {
    "name": Coalesce(NullIf(Upper("ref"), _NOTHING), NullIf(Upper("name"), _NOTHING), Value(LAST_NAME)),
    "kind": F("kind"),
    "voltage": Coalesce("max_voltage_v", "line__max_voltage_v", Value(0), output_field=IntegerField()),
    "operator": Coalesce(NullIf(OPERATOR, _NOTHING), Value(LAST_NAME)),
    "height": Coalesce("height_m", Value(0.0), output_field=FloatField()),
    "length": Coalesce("length_m", Value(0.0), output_field=FloatField()),
    "changed": F("updated_at"),
}
ASSET_ORDERS = (*_ORDERS, "inspected")


def assets_in_order(assets: QuerySet[DrawnAsset], order: str, organisation_id: int) -> tuple[QuerySet[DrawnAsset], tuple[str, ...]]:
    """Return the assets with what an order of ASSET_ORDERS compares, and the names to sort by; "-" before it reverses the order."""
    name = order.removeprefix("-")
    column = _last_inspection(organisation_id) if name == "inspected" else _ORDERS[name]
    sign = "-" if order.startswith("-") else ""
    return assets.annotate(sort_value=column), (f"{sign}sort_value", f"{sign}pk")


@dataclass(frozen=True)
class _Group:
    """Assets that agree in all facts that are counted."""

    kind: str
    voltages_v: frozenset[int]
    operator: str
    number: int


@dataclass
class _Tally:
    kinds: Counter[str] = field(default_factory=Counter)
    voltages: Counter[int] = field(default_factory=Counter)
    operators: Counter[str] = field(default_factory=Counter)
    total: int = 0


def asset_counts(wanted: AssetFilter) -> AssetCounts:
    """Count the assets of a filter, with one query; none while only kind, voltage and operator change."""
    tally = _Tally()
    for group in _groups_of(replace(wanted, kinds=(), voltages_v=(), operator="")):
        of_kind = not wanted.kinds or group.kind in wanted.kinds
        of_voltage = not wanted.voltages_v or not group.voltages_v.isdisjoint(wanted.voltages_v)
        of_operator = not wanted.operator or group.operator == wanted.operator
        if of_voltage and of_operator:
            tally.kinds[group.kind] += group.number
        if of_kind and of_operator:
            tally.voltages.update(dict.fromkeys(group.voltages_v, group.number))
        if of_kind and of_voltage and group.operator:
            tally.operators[group.operator] += group.number
        if of_kind and of_voltage and of_operator:
            tally.total += group.number
    operators = sorted(tally.operators.items(), key=lambda entry: (-entry[1], entry[0]))
    return AssetCounts(tally.total, dict(tally.kinds), sorted(tally.voltages.items(), reverse=True), operators[:MAX_OPERATORS])


def _groups_of(wanted: AssetFilter) -> tuple[_Group, ...]:
    """Return groups that are kept until the map data change, unless the filter depends on other data."""
    place = AssetFilter(organisation_id=0, flyable=wanted.flyable, line=wanted.line, region=wanted.region)
    version = ground_dataset_version()
    depends = replace(wanted, organisation_id=0) != place
    return _groups(wanted) if depends or version[1] is None else _groups_of_version(place, version)


@lru_cache(maxsize=32)
def _groups_of_version(wanted: AssetFilter, version: DatasetVersion) -> tuple[_Group, ...]:
    return _groups(wanted)


def _groups(wanted: AssetFilter) -> tuple[_Group, ...]:
    rows = Asset.objects.filter(pk__in=assets_that_match(wanted).values("pk")) if wanted.text else assets_that_match(wanted)
    grouped = rows.order_by().values("kind", "voltages_v", "line__voltages_v", stated_operator=OPERATOR).annotate(number=Count("pk"))
    return tuple(
        _Group(row["kind"], frozenset(row["voltages_v"] or row["line__voltages_v"] or ()), row["stated_operator"], row["number"])
        for row in grouped
    )
