"""Cameras, plans of photos, and tasks, in and out."""

from collections.abc import Mapping
from typing import Any

from django.utils.translation import gettext as _

from missions.fields import AboveZeroField, BetweenField
from missions.serializers.known_fields import KnownFieldsSerializer
from planning.task import (
    INSPECTION_SPEEDS_MPS,
    MAX_HOLD_S,
    MM_PER_M,
    OVERVIEW_GSD_M,
    VIEWS_HOLD_S,
    VIEWS_HOLDS_S,
    TaskKind,
    ViewPattern,
    ViewsRequest,
)
from planning.views.camera import InvalidCamera, camera_from_json, camera_to_json
from planning.views.catalogue import CatalogueCamera, catalogue
from planning.views.limits import LIMITS
from planning.views.proof import NotCounted
from planning.views.solids import Component
from workspace.api import strict_serializers as serializers
from workspace.api.fields import FiniteFloatField
from workspace.reason_texts import reason_text

MAX_MM, MAX_PIXELS, MAX_ZOOM_STEPS = 1_000.0, 50_000, 20
MAX_INTERVAL_S, MAX_NEAREST_FOCUS_M = 1_000.0, 1_000.0
GSDS_MM = (0.1, 100.0)
HEIGHTS_M = (2.0, 60.0)
ANGLES_DEG = (-180.0, 180.0)


class CameraSerializer(KnownFieldsSerializer):
    """A camera body with one lens, on a gimbal."""

    name = serializers.CharField(max_length=100)
    sensor_width_mm = AboveZeroField(max_value=MAX_MM)
    sensor_height_mm = AboveZeroField(max_value=MAX_MM)
    pixels_wide = serializers.IntegerField(min_value=1, max_value=MAX_PIXELS)
    pixels_high = serializers.IntegerField(min_value=1, max_value=MAX_PIXELS)
    focal_lengths_mm = serializers.ListField(
        child=AboveZeroField(max_value=10 * MAX_MM), min_length=1, max_length=MAX_ZOOM_STEPS,
        help_text="real focal lengths, not 35 mm equivalents, shortest first; several for a zoom",
    )  # fmt: skip
    min_interval_s = AboveZeroField(max_value=MAX_INTERVAL_S, required=False, help_text="seconds between two photos")
    nearest_focus_m = FiniteFloatField(min_value=0.0, max_value=MAX_NEAREST_FOCUS_M, required=False)
    shutter_s = AboveZeroField(max_value=10.0, required=False, help_text="exposure time of a photo")
    gimbal_pitch_min_deg = BetweenField(ANGLES_DEG, required=False, help_text="lowest angle, -90 looks straight down")
    gimbal_pitch_max_deg = BetweenField(ANGLES_DEG, required=False, help_text="highest angle, 0 is the horizon")
    gimbal_yaw_min_deg = FiniteFloatField(
        min_value=-360.0, max_value=360.0, allow_null=True, required=False, help_text="null: the UAV turns instead"
    )
    gimbal_yaw_max_deg = FiniteFloatField(min_value=-360.0, max_value=360.0, allow_null=True, required=False)
    offset_m = serializers.ListField(
        child=FiniteFloatField(min_value=-1.0, max_value=1.0), min_length=3, max_length=3, required=False,
        help_text="of the lens from the antenna: forward, right, up; poses are the lens's, and the clearance is as much more",
    )  # fmt: skip
    is_thermal = serializers.BooleanField(required=False)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        """Return the figures as they are stored; those of a changed type's camera are all needed too."""
        missing = [name for name, field in self.fields.items() if field.required and name not in attrs]
        if missing:
            raise serializers.ValidationError({name: [self.fields[name].error_messages["required"]] for name in missing})
        try:
            return camera_to_json(camera_from_json(attrs))
        except InvalidCamera as error:
            faults = {"gimbal_pitch_max_deg" if name == "gimbal" else name: reason_text(why) for name, why in error.faults.items()}
            raise serializers.ValidationError(faults) from error


class CatalogueSourceSerializer(serializers.Serializer):
    title = serializers.CharField()
    url = serializers.CharField(help_text="empty where there is no page to name")
    date = serializers.CharField()
    figures = serializers.ListField(child=serializers.CharField())


class CatalogueCameraSerializer(CameraSerializer):
    key = serializers.CharField()
    maker = serializers.CharField()
    payload = serializers.CharField()
    sources = CatalogueSourceSerializer(many=True)
    derived = serializers.DictField(child=serializers.CharField(), help_text="how figures without a source follow from others")


class CameraCatalogueSerializer(serializers.Serializer):
    results = CatalogueCameraSerializer(many=True)


class ViewsInputSerializer(KnownFieldsSerializer):
    """Photos of every part, of the whole from four sides, or of a tower's wires: with which camera, and how fine."""

    pattern = serializers.ChoiceField(
        choices=[own.value for own in ViewPattern], required=False,
        help_text="detail, which is usual: every part; overview: the whole of it in each of four photos; spans: the wires of a "
        "tower up to the middle of each span, at most 500 m, from both sides",
    )  # fmt: skip
    camera = CameraSerializer(required=False)
    camera_key = serializers.CharField(required=False, help_text="of the catalogue, in place of `camera`")
    gsd_mm = BetweenField(
        GSDS_MM, required=False,
        help_text="ground sample distance: what a pixel shows at most, across the optical axis; required, except for an overview (50)",
    )  # fmt: skip
    min_height_m = BetweenField(HEIGHTS_M, default=4.0, help_text="of the UAV above the ground")

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if "gsd_mm" not in attrs:
            if attrs.get("pattern") != ViewPattern.OVERVIEW:
                raise serializers.ValidationError({"gsd_mm": [self.fields["gsd_mm"].error_messages["required"]]})
            attrs = attrs | {"gsd_mm": OVERVIEW_GSD_M * MM_PER_M}
        if ("camera" in attrs) == ("camera_key" in attrs):
            raise serializers.ValidationError({"camera": _("State a camera or a key of the catalogue, and only one of them.")})
        if "camera_key" in attrs:
            known = catalogue().get(attrs["camera_key"])
            if known is None:
                raise serializers.ValidationError({"camera_key": _("The catalogue has no such camera.")})
            return attrs | {"camera": known.camera}
        return attrs | {"camera": camera_from_json(attrs["camera"])}


def views_request(values: Mapping[str, Any]) -> ViewsRequest:
    pattern = ViewPattern(values.get("pattern", ViewPattern.DETAIL))
    return ViewsRequest(values["gsd_mm"] / MM_PER_M, values["camera"], values["min_height_m"], pattern)


class ViewPlanInputSerializer(ViewsInputSerializer):
    asset = serializers.IntegerField(min_value=1, help_text="id of a power tower or a bridge")


class ViewsSerializer(serializers.Serializer):
    """Photos of a target."""

    pattern = serializers.ChoiceField(
        choices=[own.value for own in ViewPattern], required=False, help_text="not there: detail, photos of every part"
    )
    gsd_mm = serializers.FloatField(help_text="ground sample distance: what a pixel shows at most, across the optical axis")
    min_height_m = serializers.FloatField(help_text="of the UAV above the ground")
    camera = CameraSerializer()


class ViewSerializer(serializers.Serializer):
    """How one photo is taken."""

    yaw_deg = serializers.FloatField(help_text="of the camera, from true north, clockwise")
    pitch_deg = serializers.FloatField(help_text="0 is the horizon, -90 straight down")
    distance_m = serializers.FloatField(help_text="along the optical axis to what it shows")
    focal_length_mm = serializers.FloatField()
    clearance_m = serializers.FloatField(help_text="which the flight through these photos keeps from wires and supports")
    heading_deg = serializers.FloatField(allow_null=True, help_text="of the UAV's nose, where the gimbal cannot pan all around; null: any")


class TowerModelSerializer(serializers.Serializer):
    form = serializers.CharField()
    height_m = serializers.FloatField()
    height_source = serializers.ChoiceField(choices=["tag", "line", "assumed"])
    voltage_v = serializers.FloatField(allow_null=True)
    is_anchor = serializers.BooleanField()
    bearing_deg = serializers.FloatField(help_text="of the line at the tower")


class BridgeModelSerializer(serializers.Serializer):
    """What a bridge is taken to look like. Heights count from the ground in its middle."""

    deck_height_m = serializers.FloatField()
    deck_source = serializers.ChoiceField(
        choices=["tag", "layer"], help_text="tag: its stated height; layer: the terrain at its ends, and 6.5 m for each layer below it"
    )
    top_m = serializers.FloatField(help_text="as high as plans count it; flights pass above that")
    length_m = serializers.FloatField()
    width_m = serializers.FloatField()
    piers = serializers.IntegerField(help_text="assumed every 30 m: map data do not state where they are")
    bearing_deg = serializers.FloatField(help_text="of its axis, 0 to 180")


class PlannedPhotoSerializer(serializers.Serializer):
    position = serializers.ListField(child=serializers.FloatField(), help_text="lon, lat")
    height_agl_m = serializers.FloatField(allow_null=True, help_text="above the ground under the UAV; null without terrain data there")
    height_m = serializers.FloatField(help_text="above the ground at the tower, or in the middle of the bridge")
    yaw_deg = serializers.FloatField(help_text="from true north, clockwise")
    pitch_deg = serializers.FloatField(help_text="0 is the horizon, -90 straight down")


class ComponentCoverageSerializer(serializers.Serializer):
    component = serializers.ChoiceField(choices=[own.value for own in Component])
    number = serializers.IntegerField(help_text="among those of its kind, from 0; of wires: left, then right side of each span")
    area_m2 = serializers.FloatField()
    shown = serializers.FloatField(help_text="share of the area, 0 to 1")
    reachable = serializers.FloatField(help_text="share of the area that a photo can show")
    gsd_mm = serializers.FloatField(allow_null=True, help_text="95 % of what is shown is as fine or finer")
    angle_deg = serializers.FloatField(allow_null=True, help_text="from the surface's normal, likewise")
    limit = serializers.ChoiceField(
        choices=[own.value for own in LIMITS if own], allow_null=True, help_text="why most of the rest cannot be shown"
    )


class ViewCoverageSerializer(serializers.Serializer):
    shown = serializers.FloatField()
    reachable = serializers.FloatField()
    shown_of_reachable = serializers.FloatField()
    components = ComponentCoverageSerializer(many=True)


class NotCountedSerializer(serializers.Serializer):
    reason = serializers.ChoiceField(
        choices=[own.value for own in NotCounted],
        help_text="failed: the camera reported a failure; position, height, attitude: unknown, of heights also their reference; tilted: "
        "more roll than 3°; far: from the asset",
    )
    count = serializers.IntegerField()


class ShownSerializer(serializers.Serializer):
    """What photos show. The camera counts as level, with the planned focal length."""

    photos = serializers.IntegerField(help_text="that count")
    not_counted = NotCountedSerializer(many=True)
    coverage = ViewCoverageSerializer()


class DeviationSerializer(serializers.Serializer):
    """A planned photo that was not taken, or from elsewhere: more than 0.5 m or 1° off."""

    photo = serializers.IntegerField(help_text="of the target, from 1")
    uav = serializers.IntegerField(help_text="place in the mission")
    waypoint = serializers.IntegerField(help_text="sequence in its route")
    off_m = serializers.FloatField(allow_null=True, help_text="null: not taken, or not counted")
    off_deg = serializers.FloatField(allow_null=True, help_text="between the optical axes")
    not_counted = serializers.ChoiceField(
        choices=[own.value for own in NotCounted], allow_null=True, help_text="why one that was taken is not counted"
    )


class RehearsedCoverageSerializer(ShownSerializer):
    rehearsal = serializers.UUIDField()
    run = serializers.IntegerField(help_text="which of its conditions")
    code = serializers.CharField(help_text="of the conditions")
    name = serializers.CharField(allow_blank=True, help_text="of own conditions")
    is_outdated = serializers.BooleanField(help_text="another plan was flown")
    deviations = DeviationSerializer(many=True)


class AchievedCoverageSerializer(ShownSerializer):
    deviations = DeviationSerializer(many=True)


class MissingComponentSerializer(serializers.Serializer):
    component = serializers.ChoiceField(choices=[own.value for own in Component])
    number = serializers.IntegerField()


class TargetCoverageSerializer(serializers.Serializer):
    target = serializers.IntegerField(help_text="place in the mission")
    label = serializers.CharField()  # type: ignore[assignment]  # the field, not DRF's label
    asset = serializers.IntegerField(allow_null=True)
    camera = serializers.CharField()
    gsd_mm = serializers.FloatField()
    focal_length_mm = serializers.FloatField(allow_null=True)
    promised = ShownSerializer(allow_null=True, help_text="by the planned photos; null where none are planned, or the asset is gone")
    rehearsed = RehearsedCoverageSerializer(many=True, help_text="one of each run")
    achieved = AchievedCoverageSerializer(allow_null=True, help_text="by reported photos; null while nothing was flown")
    is_short = serializers.BooleanField(
        allow_null=True, help_text="over 2 % of the area less was achieved than promised, or a component is missing; null without achieved"
    )
    missing = MissingComponentSerializer(many=True, help_text="components of which at least 10 % was promised, and nothing is achieved")


class MissionCoverageSerializer(serializers.Serializer):
    results = TargetCoverageSerializer(many=True)
    next = serializers.CharField(allow_null=True, help_text="path and query of the next page")


class ViewPlanZoneSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()


class ViewPlanSerializer(ViewsSerializer):
    """Planned photos, with what was asked for."""

    asset = serializers.IntegerField()
    focal_length_mm = serializers.FloatField(help_text="with which the photos are taken")
    farthest_m = serializers.FloatField(help_text="distance up to which they are fine enough")
    clearance_m = serializers.FloatField(help_text="least distance from wires and supports")
    has_terrain = serializers.BooleanField(help_text="without, the ground counts as level with the foot of the asset")
    model = TowerModelSerializer(allow_null=True, help_text="of a tower")
    bridge = BridgeModelSerializer(allow_null=True)
    photos = PlannedPhotoSerializer(many=True, help_text="in the order in which they are taken")
    photos_bound = serializers.IntegerField(
        help_text="no choice of fewer photos among the candidates shows enough; of overviews and wires the number of photos"
    )
    route = serializers.ListField(
        child=serializers.ListField(child=serializers.FloatField()),
        help_text="lon, lat, and metres above the ground at the asset; from above the asset and back to there",
    )
    length_m = serializers.FloatField()
    duration_s = serializers.FloatField()
    coverage = ViewCoverageSerializer()
    zones = ViewPlanZoneSerializer(many=True, help_text="no-fly zones that the flight would meet at some time: it cannot be flown then")


def catalogue_json(own: CatalogueCamera) -> dict[str, Any]:
    return camera_to_json(own.camera) | {
        "key": own.key, "maker": own.maker, "payload": own.payload, "sources": list(own.sources), "derived": own.derived,
    }  # fmt: skip


class TaskSerializer(KnownFieldsSerializer):
    """Task at a target. Without `hold_s` the kind's default: 5 s to look, 10 s for photos, 30 s to hold; with `views` 3 s at each photo."""

    kind = serializers.ChoiceField(choices=[(kind.value, kind.value) for kind in TaskKind])
    hold_s = FiniteFloatField(min_value=0, max_value=MAX_HOLD_S, required=False)
    views = ViewsInputSerializer(required=False, allow_null=True, help_text="with photo, of a power tower: photos from planned poses")
    speed_mps = FiniteFloatField(
        min_value=INSPECTION_SPEEDS_MPS[0],
        max_value=INSPECTION_SPEEDS_MPS[1],
        required=False,
        allow_null=True,
        help_text="with look, of a line or railway that is flown along: over ground at most; null: as the UAV flies",
    )

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if attrs.get("speed_mps") is not None and attrs["kind"] != TaskKind.LOOK:
            raise serializers.ValidationError({"speed_mps": _("Only a look along a line has a speed.")})
        if attrs.get("views") and attrs["kind"] != TaskKind.PHOTO:
            raise serializers.ValidationError({"views": _("Only photos have views.")})
        low_s, high_s = VIEWS_HOLDS_S
        if attrs.get("views") and not low_s <= attrs.get("hold_s", VIEWS_HOLD_S) <= high_s:
            problem = _("From %(low)s to %(high)s s at each photo.") % {"low": f"{low_s:g}", "high": f"{high_s:g}"}
            raise serializers.ValidationError({"hold_s": problem})
        return attrs


class TaskOutputSerializer(serializers.Serializer):
    kind = serializers.ChoiceField(choices=[(kind.value, kind.value) for kind in TaskKind])
    hold_s = serializers.FloatField()
    views = ViewsSerializer(required=False, help_text="of a target that is photographed from planned poses")
    view = ViewSerializer(required=False, help_text="of a waypoint at which one of these photos is taken")
    speed_mps = serializers.FloatField(required=False, help_text="along a line or railway, over ground at most")
