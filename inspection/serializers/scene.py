"""Map data of a box for the 3D view, as described in docs/scene.md."""

from typing import Any

import numpy as np
import shapely
from rest_framework import serializers

from inspection.geodesy.wgs84 import FloatArray
from inspection.models import Asset
from inspection.network.inspection_graph import NodeKind
from inspection.network.rules import UNTAGGED_HEIGHT_M
from inspection.scene.overhead import CATENARY_M, EARTH_SHARE, MAX_SAG_SHARE
from inspection.scene.supports import DrawnSpan, DrawnSupport
from inspection.selectors import asset_label
from inspection.selectors.scene import SceneBridge, SceneContent, SceneZone
from inspection.serializers.terrain import LonLatField
from inspection.serializers.zones import LimitSerializer, ScheduleField, limit_json, schedule_words
from workspace.jobs.serializers import Declared

DEGREE_DIGITS, METRE_DIGITS = 7, 2
OPEN_TOP_AGL_M = 180.0  # drawn height of a zone without an upper limit: half as much again as the highest flight


class GroundGridSerializer(serializers.Serializer):
    """Terrain heights on a grid; bilinear between its posts."""

    kind = serializers.ChoiceField(choices=["terrain", "partly", "flat"], help_text="partly: what is unknown has the mean of the rest")
    west_deg = serializers.FloatField()
    north_deg = serializers.FloatField()
    step_lon_deg = serializers.FloatField()
    step_lat_deg = serializers.FloatField()
    columns = serializers.IntegerField()
    rows = serializers.IntegerField()
    altitude_amsl_m = serializers.ListField(child=serializers.FloatField(), help_text="row by row from the north-west; flat ground is 0")


class PairField(serializers.ListField):
    """Two numbers in metres."""

    child = serializers.FloatField()


class SupportSerializer(serializers.Serializer):
    """A tower, pole or portal, or a bend of a line without a mapped support."""

    id = serializers.IntegerField(allow_null=True)
    label: Declared = serializers.CharField(allow_null=True)
    kind = serializers.ChoiceField(choices=["tower", "pole", "portal", "vertex"])
    form = serializers.ChoiceField(choices=["lattice", "tubular", "wooden", "h-frame", "portal", "guyed", "stake"])
    position = LonLatField()
    ground_amsl_m = serializers.FloatField()
    height_m = serializers.FloatField(help_text="above its ground; what planners count")
    height_source = serializers.ChoiceField(choices=["tag", "line", "assumed"])
    likely_m = serializers.FloatField(help_text="above its ground, as it is drawn: below height_m where it likely is")
    voltage_v = serializers.IntegerField(allow_null=True)
    is_anchor = serializers.BooleanField(help_text="wires end here, and are not hung below the arms")
    bearing_deg = serializers.FloatField(help_text="along the line; its arms stand across")
    arms = serializers.ListField(child=PairField(), help_text="height above ground, left end, right end across [m]")
    slots = serializers.ListField(child=PairField(), help_text="where phases hang: across, height above ground [m]")
    earth = serializers.ListField(child=PairField(), help_text="where earth wires hang: across, height above ground [m]")


class SpanSerializer(serializers.Serializer):
    """Wires between two supports; never above the straight line between their tops."""

    to = serializers.IntegerField(help_text="place in supports")
    lines = serializers.ListField(child=serializers.IntegerField())
    voltage_v = serializers.IntegerField(allow_null=True)
    phases = serializers.IntegerField()
    earth = serializers.IntegerField(help_text="earth wires")
    length_m = serializers.FloatField()
    sag_m = serializers.FloatField(help_text="of a phase in the middle, below the straight line between its ends")

    def get_fields(self) -> dict[str, Any]:
        """Return the fields with `from`, which is a Python keyword."""
        return {"from": serializers.IntegerField(help_text="place in supports"), **super().get_fields()}


class RailwaySerializer(serializers.Serializer):
    id = serializers.IntegerField()
    label: Declared = serializers.CharField()
    kind = serializers.CharField()
    tracks = serializers.IntegerField()
    is_electrified = serializers.BooleanField(help_text="with a wire above the track")
    line = serializers.ListField(child=LonLatField())


class SceneBridgeSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    label: Declared = serializers.CharField()
    is_named = serializers.BooleanField(help_text="its label is a name or number of its own")
    carries = serializers.CharField()
    polygons = serializers.ListField(child=serializers.ListField(child=serializers.ListField(child=LonLatField())))
    deck_amsl_m = serializers.FloatField()
    deck_source = serializers.ChoiceField(choices=["tag", "layer"])
    height_m = serializers.FloatField(help_text="its top above ground, as planners count it")
    height_source = serializers.ChoiceField(choices=["tag", "assumed"])


class SceneLimitSerializer(serializers.Serializer):
    above = serializers.ChoiceField(choices=["ground", "sea", "open"], help_text="open: may reach any height")
    m = serializers.FloatField(allow_null=True)


class SceneZoneSerializer(serializers.Serializer):
    """A no-fly zone's volume, as planners count it."""

    id = serializers.IntegerField()
    name = serializers.CharField()
    restriction = serializers.CharField()
    polygons = serializers.ListField(
        child=serializers.ListField(child=serializers.ListField(child=LonLatField())), help_text="outline and holes of each, cut at clip"
    )
    lower = SceneLimitSerializer()
    upper = SceneLimitSerializer()
    lower_limit = LimitSerializer(allow_null=True)
    upper_limit = LimitSerializer(allow_null=True)
    schedule = ScheduleField(allow_null=True)
    schedule_words = serializers.CharField()


class SceneRulesSerializer(serializers.Serializer):
    """Assumptions for the whole scene."""

    catenary_m = serializers.FloatField(help_text="horizontal pull over weight by length of a phase")
    most_sag_share = serializers.FloatField(help_text="of the lowest slot's height: no sag is greater")
    earth_sag_share = serializers.FloatField(help_text="of a phase's sag")
    open_top_agl_m = serializers.FloatField(help_text="zones without an upper limit are drawn as high")
    rail_wire_agl_m = serializers.FloatField(help_text="what planners count of a railway")


class OriginSerializer(serializers.Serializer):
    position = LonLatField()
    altitude_amsl_m = serializers.FloatField()


class SceneSerializer(serializers.Serializer):
    box = serializers.ListField(child=serializers.FloatField(), help_text="west, south, east, north")
    clip = serializers.ListField(child=serializers.FloatField(), help_text="where railways and zones are cut")
    origin = OriginSerializer()
    ground = GroundGridSerializer()
    supports = SupportSerializer(many=True)
    spans = SpanSerializer(many=True)
    railways = RailwaySerializer(many=True)
    bridges = SceneBridgeSerializer(many=True)
    zones = SceneZoneSerializer(many=True)
    rules = SceneRulesSerializer()
    left_out = serializers.DictField(child=serializers.IntegerField(), help_text="beyond the limits, the farthest from the middle first")


def scene_json(scene: SceneContent) -> dict[str, Any]:
    ground = scene.ground
    rows, columns = ground.altitude_amsl_m.shape
    return {
        "box": list(scene.box),
        "clip": _rounded(np.array(scene.clip), DEGREE_DIGITS),
        "origin": {"position": list(scene.middle), "altitude_amsl_m": round(scene.origin_amsl_m, METRE_DIGITS)},
        "ground": {
            "kind": ground.kind,
            "west_deg": ground.west_deg,
            "north_deg": ground.north_deg,
            "step_lon_deg": ground.step_lon_deg,
            "step_lat_deg": ground.step_lat_deg,
            "columns": columns,
            "rows": rows,
            "altitude_amsl_m": _rounded(ground.altitude_amsl_m.ravel(), METRE_DIGITS),
        },
        "supports": [
            _support_json(drawn, scene.assets.get(key), position, ground_m)
            for drawn, key, position, ground_m in zip(
                scene.supports, scene.place.support.tolist(), scene.place.position, scene.support_amsl_m.tolist(), strict=True
            )
        ],
        "spans": [_span_json(span) for span in scene.spans],
        "railways": [_railway_json(asset, line) for asset, shape in scene.railways for line in _lines(shape)],
        "bridges": [_bridge_json(bridge) for bridge in scene.bridges],
        "zones": [_zone_json(zone) for zone in scene.zones],
        "rules": {
            "catenary_m": CATENARY_M,
            "most_sag_share": MAX_SAG_SHARE,
            "earth_sag_share": EARTH_SHARE,
            "open_top_agl_m": OPEN_TOP_AGL_M,
            "rail_wire_agl_m": UNTAGGED_HEIGHT_M[NodeKind.RAILWAY],
        },
        "left_out": scene.left_out,
    }


def _support_json(drawn: DrawnSupport, asset: Asset | None, position: FloatArray, ground_m: float) -> dict[str, Any]:
    return {
        "id": asset.pk if asset else None,
        "label": asset_label(asset) if asset else None,
        "kind": drawn.kind,
        "form": drawn.form.value,
        "position": _rounded(position, DEGREE_DIGITS),
        "ground_amsl_m": round(ground_m, METRE_DIGITS),
        "height_m": round(drawn.height_m, METRE_DIGITS),
        "height_source": drawn.height_source,
        "likely_m": round(drawn.likely_m, METRE_DIGITS),
        "voltage_v": drawn.voltage_v,
        "is_anchor": drawn.is_anchor,
        "bearing_deg": round(drawn.bearing_deg, 1),
        "arms": [_metres(arm) for arm in drawn.arms.arms],
        "slots": [_metres(slot) for slot in drawn.arms.slots],
        "earth": [_metres(slot) for slot in drawn.arms.earth],
    }


def _span_json(span: DrawnSpan) -> dict[str, Any]:
    return {
        "from": span.start,
        "to": span.end,
        "lines": list(span.lines),
        "voltage_v": span.voltage_v,
        "phases": span.phases,
        "earth": span.earth,
        "length_m": round(span.length_m, METRE_DIGITS),
        "sag_m": round(span.sag_m, METRE_DIGITS),
    }


def _railway_json(asset: Asset, line: shapely.LineString) -> dict[str, Any]:
    tracks = asset.tags.get("tracks", "")
    return {
        "id": asset.pk,
        "label": asset_label(asset),
        "kind": asset.subtype,
        "tracks": min(int(tracks), 8) if tracks.isascii() and tracks.isdigit() and len(tracks) < 4 and int(tracks) > 0 else 1,
        "is_electrified": asset.tags.get("electrified") in {"contact_line", "yes"},
        "line": _positions(line),
    }


def _bridge_json(bridge: SceneBridge) -> dict[str, Any]:
    return {
        "id": bridge.asset.pk,
        "label": asset_label(bridge.asset),
        "is_named": bool(bridge.asset.ref or bridge.asset.name),
        "carries": bridge.asset.carries,
        "polygons": _polygons(bridge.shape),
        "deck_amsl_m": round(bridge.deck_amsl_m, METRE_DIGITS),
        "deck_source": bridge.deck_source,
        "height_m": round(bridge.height_m, METRE_DIGITS),
        "height_source": bridge.height_source,
    }


def _zone_json(scene_zone: SceneZone) -> dict[str, Any]:
    zone = scene_zone.zone
    return {
        "id": zone.pk,
        "name": zone.name,
        "restriction": zone.restriction,
        "polygons": _polygons(scene_zone.shape),
        "lower": _limit(zone.lower_limit_m, zone.lower_reference, scene_zone.lower_is_open),
        "upper": _limit(zone.upper_limit_m, zone.upper_reference, scene_zone.upper_is_open),
        "lower_limit": limit_json(zone.lower_limit_m, zone.lower_reference),
        "upper_limit": limit_json(zone.upper_limit_m, zone.upper_reference),
        "schedule": zone.schedule,
        "schedule_words": schedule_words(zone.schedule),
    }


def _limit(value_m: float | None, reference: str, is_open: bool) -> dict[str, Any]:
    return {"above": "open", "m": None} if is_open else {"above": "ground" if reference == "AGL" else "sea", "m": value_m}


def _metres(values: tuple[float, ...]) -> list[float]:
    return [round(value, METRE_DIGITS) for value in values]


def _rounded(values: FloatArray, digits: int) -> list[float]:
    return np.round(values, digits).tolist()


def _positions(line: shapely.LineString | shapely.LinearRing) -> list[list[float]]:
    return np.round(shapely.get_coordinates(line), DEGREE_DIGITS).tolist()


def _lines(shape: shapely.geometry.base.BaseGeometry) -> list[shapely.LineString]:
    return [part for part in shapely.get_parts(shapely.line_merge(shape)) if isinstance(part, shapely.LineString)]


def _polygons(shape: shapely.geometry.base.BaseGeometry) -> list[list[list[list[float]]]]:
    parts = [polygon for part in shapely.get_parts(shape) for polygon in shapely.get_parts(part) if isinstance(polygon, shapely.Polygon)]
    return [[_positions(ring) for ring in (polygon.exterior, *polygon.interiors)] for polygon in parts if not polygon.is_empty]
