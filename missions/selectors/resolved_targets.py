"""Resolve picked targets to geometry: a point, or the course of a line."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from django.contrib.gis.geos import GEOSGeometry, LineString, MultiPolygon, Point, Polygon
from django.utils.translation import gettext as _
from django.utils.translation import override

from inspection.geodesy import LonLat, distance_m
from inspection.geodesy.stretches import line_end, nearest_on_line, stretch_between
from inspection.models import Asset, AssetKind
from inspection.selectors import asset_label
from inspection.selectors.picking import label_between
from inspection.selectors.planning import PointAsset, planning_read
from operation.reasons import Reason
from planning.context import ResolvedTarget
from planning.request import InvalidRequest, TargetRequest
from planning.task import Task, default_task
from planning.trajectory.heights import FloatArray, asset_height_m
from workspace.locale_negotiation import number_text

NEAR_ASSET_M = 500.0  # a picked point farther from its asset is an error
LINEAR = {AssetKind.LINE, AssetKind.RAILWAY}


@dataclass(frozen=True)
class NamedTarget(ResolvedTarget):
    """A resolved target with a label."""

    called: Callable[[], str] = field(kw_only=True, compare=False, repr=False)

    @cached_property
    def label(self) -> str:
        """Return the target's name in English: it is stored, for readers of any language."""
        with override("en"):
            return self.called()


def whole_assets(targets: Sequence[TargetRequest]) -> list[int]:
    """Return the keys of the assets if every target is a whole asset, as in most small plans; else an empty list."""
    keys = [target.asset for target in targets if target.asset is not None and target.position is None and target.stretch is None]
    return keys if len(keys) == len(targets) else []


def resolved_targets(
    targets: Sequence[TargetRequest], points: Mapping[int, PointAsset] | None = None
) -> tuple[list[NamedTarget], list[int]]:
    """Return the place of each target, and the targets whose asset has been deleted since they were picked.

    points: the towers and bridges among `whole_assets`, if already read. Raises InvalidRequest with every fault: an unknown asset, a point
    or stretch that is not on its asset.
    """
    plain = _whole_towers_and_bridges(targets, points)
    if plain is not None:
        return plain, []
    assets = Asset.objects.defer("tags", "node_osm_ids", "parts").in_bulk({target.asset for target in targets if target.asset is not None})
    places: list[NamedTarget] = []
    gone: list[int] = []
    faults: dict[str, Reason | str] = {}
    for index, target in enumerate(targets):
        if target.asset is None:
            if target.position is None:
                gone.append(index)
            else:
                places.append(_place_at(target.position, index, target))
        elif target.asset not in assets:
            faults[f"targets.{index}.asset"] = f"There is no asset {target.asset}."
        else:
            try:
                places.append(_place_on(assets[target.asset], index, target))
            except InvalidRequest as error:
                faults |= error.faults
    if faults:
        raise InvalidRequest(faults)
    return places, gone


def _whole_towers_and_bridges(targets: Sequence[TargetRequest], points: Mapping[int, PointAsset] | None) -> list[NamedTarget] | None:
    """Return the places if all targets are whole towers and bridges; None where any target needs a closer check."""
    keys = whole_assets(targets)
    if not keys:
        return None
    found = planning_read(keys).points if points is None else points
    if any(key not in found for key in keys):
        return None
    return [_plain_place(found[key], index, target) for index, (key, target) in enumerate(zip(keys, targets, strict=True))]


def _plain_place(point: PointAsset, index: int, target: TargetRequest) -> NamedTarget:
    height_m = asset_height_m(kind=point.kind, subtype=point.subtype, tagged_m=point.height_m, voltage_v=point.max_voltage_v)
    task = _task(index, target, point.kind, is_path=False)
    return NamedTarget(index, (point.position,), task, height_m, point.key, point.kind, called=lambda: asset_label(point.as_asset()))


def _place_at(position: LonLat, index: int, target: TargetRequest) -> NamedTarget:
    return NamedTarget(index, (position,), _task(index, target, None, is_path=False), 0.0, called=partial(position_label, position))


def position_label(position: LonLat) -> str:
    return f"{position.lat:.5f}, {position.lon:.5f}"


def _place_on(asset: Asset, index: int, target: TargetRequest) -> NamedTarget:
    course = _course(asset, index, target)
    called = partial(asset_label, asset) if target.stretch is None else partial(label_between, asset, *target.stretch)
    return NamedTarget(
        target=index,
        course=course,
        task=_task(index, target, asset.kind, is_path=len(course) > 1),
        height_m=asset_height_m(kind=asset.kind, subtype=asset.subtype, tagged_m=asset.height_m, voltage_v=asset.max_voltage_v),
        asset=asset.pk,
        kind=asset.kind,
        called=called,
    )


def _task(index: int, target: TargetRequest, kind: str | None, *, is_path: bool) -> Task:
    if target.task is not None and target.task.speed_mps is not None and not is_path:
        raise InvalidRequest({f"targets.{index}.task": _("Only a look along a line has a speed.")})
    return target.task or default_task(kind, is_path=is_path)


def _course(asset: Asset, index: int, target: TargetRequest) -> tuple[LonLat, ...]:
    if asset.kind in LINEAR:
        return _course_on_line(asset, index, target)
    if target.stretch is not None:
        raise InvalidRequest({f"targets.{index}.stretch": _("Only a line or a railway has stretches.")})
    centre = LonLat(*asset.centre.coords)
    if target.position is None:
        return (centre,)
    if asset.kind == AssetKind.TOWER:
        _refuse_far(f"targets.{index}.position", float(distance_m(np.array(centre), np.array(target.position))[0]))
        return (centre,)
    place = _on_area(asset.geometry, index, target.position)
    has_views = target.task is not None and target.task.views is not None
    return (centre if has_views else place,)  # photos are planned from over the middle


def _course_on_line(asset: Asset, index: int, target: TargetRequest) -> tuple[LonLat, ...]:
    line = _line(asset, index)
    if target.position is not None:
        place = nearest_on_line(line, target.position)
        _refuse_far(f"targets.{index}.position", place.distance_m)
        return (place.position,)
    if target.stretch is None:
        return stretch_between(line, line_end(line, 0), line_end(line, -1))
    ends = []
    for number, position in enumerate(target.stretch):
        ends.append(nearest_on_line(line, position))
        _refuse_far(f"targets.{index}.stretch.{number}", ends[-1].distance_m)
    course = stretch_between(line, *ends)
    if len(course) < 2:
        raise InvalidRequest({f"targets.{index}.stretch": _("Both ends are the same point of the line.")})
    return course


def _line(asset: Asset, index: int) -> FloatArray:
    if not isinstance(asset.geometry, LineString):
        raise InvalidRequest({f"targets.{index}.asset": _("This asset is not drawn as one line, so it cannot be flown along.")})
    return np.array(asset.geometry.coords, dtype=np.float64)[:, :2]


def _on_area(geometry: GEOSGeometry, index: int, position: LonLat) -> LonLat:
    """Return the position itself if it is on the bridge's area, else the nearest point of its outline."""
    if geometry.contains(Point(*position, srid=4326)):
        return position
    parts = geometry if isinstance(geometry, MultiPolygon) else [geometry]
    outlines = [np.array(ring.coords)[:, :2] for part in parts if isinstance(part, Polygon) for ring in part]
    nearest = min((nearest_on_line(outline, position) for outline in outlines), key=lambda place: place.distance_m)
    _refuse_far(f"targets.{index}.position", nearest.distance_m)
    return nearest.position


def _refuse_far(where: str, metres: float) -> None:
    if metres > NEAR_ASSET_M:
        raise InvalidRequest(
            {
                where: _("This point is %(metres)s m from the asset; up to %(near_asset_m)s m is taken as a point on it.")
                % {"metres": number_text(metres), "near_asset_m": f"{NEAR_ASSET_M:.0f}"}
            }
        )
