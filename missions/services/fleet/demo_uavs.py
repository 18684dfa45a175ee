"""The demo region's UAVs with their types and bases: created, and deleted with the region."""

from contextlib import suppress

from django.contrib.gis.geos import Point
from django.utils import timezone

from inspection.demo_region import BASES, BasedUav, DemoBase
from missions.models import Base, Uav, UavType
from missions.services.commands.refused import Refused
from missions.services.fleet.rows import FleetRowInUse
from missions.services.fleet.types_and_bases import delete_base, delete_uav_type
from missions.services.fleet.uavs import delete_uav
from planning.views.camera import camera_to_json
from planning.views.catalogue import catalogue
from workspace.models import Organisation, User

TYPE_FIGURES = ("max_range_m", "cruise_speed_mps", "battery_wh", "mass_kg", "max_airspeed_mps", "rotor_disk_m2", "hover_power_w")


def create_demo_uavs(*, organisation: Organisation) -> int:
    """Create the missing demo UAVs and return how many are new; existing ones keep their values and positions."""
    return sum(_create_uav(uav, _base(base, organisation), organisation) for base in BASES for uav in base.uavs)


def _base(planned: DemoBase, organisation: Organisation) -> Base:
    location = Point(*planned.position, srid=4326)
    return Base.objects.get_or_create(organisation=organisation, name=planned.name, defaults={"location": location})[0]


def _create_uav(uav: BasedUav, base: Base, organisation: Organisation) -> bool:
    """Create a UAV. Its type, named like it without the number, supplies range, speed, sensors, cameras and performance."""
    cameras = [camera_to_json(catalogue()[key].camera) for key in uav.cameras]
    facts = {name: getattr(uav, name) for name in TYPE_FIGURES} | {"sensors": list(uav.sensors), "cameras": cameras}
    uav_type, _ = UavType.objects.get_or_create(organisation=organisation, name=uav.type_name, defaults=facts)
    _, is_new = Uav.objects.get_or_create(
        organisation=organisation,
        name=uav.name,
        defaults={
            "uav_type": uav_type,
            "base": base,
            "base_name": base.name,
            "location": base.location,
            "located_at": timezone.now(),
            "battery_percent": 100.0,
            "is_simulated": True,
            "is_demo": True,
        },
    )
    return is_new


def positions_of_bases(organisation_id: int) -> list[tuple[float, float]]:
    return [(base.location.x, base.location.y) for base in Base.objects.filter(organisation=organisation_id)]


def delete_demo_uavs(actor: User) -> None:
    """Delete the demo's UAVs of the user's organisation, then the bases and types that they leave. Those in use by missions stay."""
    organisation = actor.organisation_id
    types = list(UavType.objects.filter(organisation=organisation, uavs__is_demo=True).distinct())
    for uav in Uav.objects.filter(organisation=organisation, is_demo=True, twin_of=None):
        with suppress(FleetRowInUse, Refused):
            delete_uav(uav=uav, actor=actor)
    for planned in BASES:
        base = Base.objects.filter(organisation=organisation, name=planned.name, location=Point(*planned.position, srid=4326)).first()
        if base is not None:
            with suppress(FleetRowInUse):
                delete_base(base=base, actor=actor, expected_revision=None)
    for uav_type in types:
        with suppress(FleetRowInUse):
            delete_uav_type(uav_type=uav_type, actor=actor, expected_revision=None)
