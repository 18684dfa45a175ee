"""Reads of saved selections, always within one organisation."""

from dataclasses import dataclass
from typing import Any

from django.db.models import QuerySet

from inspection.models import Asset
from missions.models import SavedSelection
from workspace.models import Organisation

# columns of an asset that a row of targets shows
SHOWN_OF_AN_ASSET = (
    "kind", "subtype", "osm_type", "osm_id", "centre", "name", "ref", "operator", "voltages_v", "max_voltage_v", "length_m", "carries",
    "place_on_line", "places_on_line", "vanished_at", "line__ref", "line__name", "line__operator", "line__max_voltage_v",
)  # fmt: skip


@dataclass(frozen=True)
class KeptTarget:
    """A saved target with its current asset; `asset` is None for a bare position and for a deleted asset."""

    value: dict[str, Any]
    asset: Asset | None

    @property
    def is_missing(self) -> bool:
        return self.value["asset"] is not None and (self.asset is None or self.asset.vanished_at is not None)


def selections_of_organisation(organisation: Organisation, *, text: str = "") -> QuerySet[SavedSelection]:
    selections = SavedSelection.objects.filter(organisation=organisation).select_related("author")
    return selections.filter(name__icontains=text) if text else selections


def kept_targets(selection: SavedSelection) -> list[KeptTarget]:
    keys = {target["asset"] for target in selection.targets if target["asset"] is not None}
    assets = Asset.objects.select_related("line").only(*SHOWN_OF_AN_ASSET).in_bulk(keys)
    return [KeptTarget(target, assets.get(target["asset"])) for target in selection.targets]
