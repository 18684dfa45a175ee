"""Assets as short rows to pick from, and the requests for them."""

from collections.abc import Iterable
from typing import Any

from inspection.models import Asset, AssetKind
from inspection.selectors import asset_detail, asset_label
from inspection.serializers.assets import FIELDS_OF_AN_ASSET
from workspace.api import strict_serializers as serializers
from workspace.jobs.serializers import Declared

MAX_REFS = 2_000
MAX_REF_LENGTH = 255
MAX_CORNERS = 5_000
MAX_LINES = 500  # as many as a mission takes targets


class PickedAssetSerializer(serializers.Serializer):
    """An asset as a list of targets shows it; for its shape see GET /assets/{id}."""

    id = serializers.IntegerField()
    kind = serializers.ChoiceField(choices=AssetKind.choices)
    label: Declared = serializers.CharField()
    detail = serializers.CharField(help_text="the second fact; may be empty")
    length_m = serializers.FloatField(allow_null=True)
    centre = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="lon, lat")
    line = serializers.IntegerField(allow_null=True, help_text="of a support: the line of the highest voltage that it carries")
    voltage_v = serializers.IntegerField(allow_null=True, help_text="highest of the asset, of a support of its line")


class LookupInputSerializer(serializers.Serializer):
    refs = serializers.ListField(
        child=serializers.CharField(max_length=MAX_REF_LENGTH),
        allow_empty=False,
        max_length=MAX_REFS,
        help_text="references, names, keys of a file, or OSM ids such as w123; case and spaces do not count",
    )
    kinds = serializers.ListField(child=serializers.ChoiceField(choices=AssetKind.choices), required=False, help_text="empty: all")


class LookupResultSerializer(serializers.Serializer):
    ref = serializers.CharField(help_text="as asked")
    match = serializers.ChoiceField(choices=["found", "several", "none"])
    count = serializers.IntegerField(help_text="how many assets it may mean")
    assets = PickedAssetSerializer(many=True, help_text="at most 20 of them")


class LookupOutputSerializer(serializers.Serializer):
    results = LookupResultSerializer(many=True, help_text="in the order asked, each reference once")


COORDINATE = serializers.FloatField(min_value=-1e6, max_value=1e6)  # degrees, or metres of a height


class DrawnAreaSerializer(serializers.Serializer):
    type = serializers.ChoiceField(choices=["Polygon"])
    coordinates = serializers.ListField(
        child=serializers.ListField(
            child=serializers.ListField(child=COORDINATE, min_length=2, max_length=3), min_length=3, max_length=MAX_CORNERS
        ),
        min_length=1,
        max_length=1,
    )


class WithinInputSerializer(serializers.Serializer):
    polygon = DrawnAreaSerializer(help_text="GeoJSON, one ring; it may cross itself and need not be closed")
    kinds = serializers.ListField(
        child=serializers.ChoiceField(choices=AssetKind.choices), required=False, help_text="default: towers and bridges"
    )


class WithinOutputSerializer(serializers.Serializer):
    count = serializers.IntegerField(help_text="how many stand there")
    assets = PickedAssetSerializer(many=True, help_text="the first 2,000 of them")


class StretchPartSerializer(serializers.Serializer):
    line = PickedAssetSerializer()
    label: Declared = serializers.CharField(help_text='the line and where on it the part lies, such as "E402, km 9.8–10.8"')
    stretch = serializers.ListField(
        child=serializers.ListField(child=serializers.FloatField()), min_length=2, max_length=2, help_text="where it begins and ends"
    )
    length_m = serializers.FloatField()


class SupportsOutputSerializer(serializers.Serializer):
    """The supports in order, and the lines between them."""

    supports = PickedAssetSerializer(many=True)
    parts = StretchPartSerializer(many=True, help_text="empty where whole lines were asked for")
    length_m = serializers.FloatField(allow_null=True)


class LinePartsOutputSerializer(serializers.Serializer):
    """Parts that several UAVs can share; each is a target with `asset` and `stretch`."""

    parts = StretchPartSerializer(many=True, help_text="in the line's direction; one where the line cannot be divided")
    length_m = serializers.FloatField()


class PartsInputSerializer(serializers.Serializer):
    assets = serializers.ListField(
        child=serializers.IntegerField(min_value=1, max_value=2**31 - 1),
        allow_empty=False,
        max_length=MAX_LINES,
        help_text="ids of lines and railways",
    )
    most = serializers.IntegerField(
        min_value=1, max_value=MAX_LINES, default=MAX_LINES, help_text="parts of all of them together: the fewer, the longer they are"
    )
    polygon = DrawnAreaSerializer(required=False, help_text="only parts that come into it; as of POST /assets/within")


class BridgesOutputSerializer(serializers.Serializer):
    sections = serializers.IntegerField(help_text="how many sections of the railway were looked at")
    bridges = PickedAssetSerializer(many=True)


def picked_assets(keys: Iterable[int]) -> list[dict[str, Any]]:
    """Return the assets of these primary keys, in their order."""
    listed = list(keys)
    rows = Asset.objects.select_related("line").only(*FIELDS_OF_AN_ASSET).in_bulk(set(listed))
    return [picked_asset(rows[key]) for key in listed if key in rows]


def picked_asset(asset: Asset) -> dict[str, Any]:
    return {
        "id": asset.pk,
        "kind": asset.kind,
        "label": asset_label(asset),
        "detail": asset_detail(asset),
        "length_m": asset.length_m,
        "centre": [asset.centre.x, asset.centre.y],
        "line": asset.line_id,
        "voltage_v": (asset.line.max_voltage_v if asset.line else None) or asset.max_voltage_v,
    }
