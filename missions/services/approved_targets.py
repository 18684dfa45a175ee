"""Targets as an approval freezes them, with the shapes of their assets: what a UAV on site plans the last metres by."""

import json
from typing import Any

from django.contrib.gis.db.models.functions import AsGeoJSON

from inspection.models import Asset
from missions.models import Mission

COORDINATE_DIGITS = 7  # about a centimetre


def approved_targets(mission: Mission) -> list[dict[str, Any]]:
    """`geometry` is GeoJSON of the whole asset: a bridge's outline, a line's course."""
    targets = list(mission.targets.all())
    assets = {target.asset_id for target in targets if target.asset_id is not None}
    shapes = Asset.objects.filter(pk__in=assets).annotate(shape=AsGeoJSON("geometry", precision=COORDINATE_DIGITS))
    known: dict[int | None, tuple[str | None, Any]] = {
        key: (kind, json.loads(shape)) for key, kind, shape in shapes.values_list("pk", "kind", "shape")
    }
    found = []
    for target in targets:
        kind, geometry = known.get(target.asset_id, (None, None))
        found.append(
            {
                "id": target.pk,
                "sequence": target.sequence,
                "asset": target.asset_id,
                "label": target.label,
                "position": None if target.position is None else list(target.position.coords),
                "stretch": [list(end) for end in target.stretch.coords] if target.stretch else None,
                "task": target.task,
                "kind": kind,
                "geometry": geometry,
            }
        )
    return found
