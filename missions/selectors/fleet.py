"""Reads of the fleet: UAVs, their types, bases and credentials, always within one organisation."""

from collections.abc import Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypedDict

from django.db.models import Count, Prefetch, Q, QuerySet

from missions.models import Base, Mission, Uav, UavCredential, UavState, UavType
from planning.energy.performance import (
    OWN_PERFORMANCE_KEYS,
    PERFORMANCE_KEYS,
    Performance,
    performance_from_json,
    performance_to_json,
)
from workspace.models import AuditEntry, Organisation

EVERY_STATE = "all"
FIGURES = ("max_range_m", "cruise_speed_mps", *PERFORMANCE_KEYS, "sensors")  # what a mission copies from a UAV and plans use


def states_out_of_service(uavs: Collection[int]) -> dict[int, str]:
    """Return why each of these UAVs cannot be planned, by id: its state, or what it lacks as "without_type" or "without_range"."""
    rows = Uav.objects.filter(pk__in=uavs).select_related("uav_type")
    return {uav.pk: uav.state for uav in rows if uav.state != UavState.ACTIVE} | incomplete_uavs(rows)


def incomplete_uavs(uavs: Iterable[Uav]) -> dict[int, str]:
    """Return what each incomplete UAV in service lacks first, by id."""
    return {uav.pk: f"without_{uav.missing[0]}" for uav in uavs if uav.state == UavState.ACTIVE and uav.missing}


def uavs_of_organisation(organisation: Organisation) -> QuerySet[Uav]:
    """Return the UAVs with their type and base."""
    return Uav.objects.filter(organisation=organisation).select_related("uav_type", "base")


def uavs_that_match(
    organisation: Organisation,
    *,
    text: str = "",
    state: str = "",
    base: int | None = None,
    uav_type: int | None = None,
    sensor: str = "",
    external_id: str = "",
    twins: bool = False,
) -> QuerySet[Uav]:
    """Return the UAVs that match. Without a state: all but retired ones. Simulated twins of other UAVs are included only if requested."""
    uavs = uavs_of_organisation(organisation)
    if not twins:
        uavs = uavs.filter(twin_of=None)
    if text:
        of_the_uav = Q(name__icontains=text) | Q(base_name__icontains=text) | Q(serial_number__icontains=text)
        uavs = uavs.filter(of_the_uav | Q(uav_type__name__icontains=text))
    if base is not None:
        uavs = uavs.filter(base=base)
    if uav_type is not None:
        uavs = uavs.filter(uav_type=uav_type)
    if sensor:
        uavs = uavs.filter(Q(sensor__icontains=sensor) | Q(uav_type__sensors__icontains=sensor))
    if external_id:
        uavs = uavs.filter(external_id=external_id)
    if state == EVERY_STATE:
        return uavs
    return uavs.filter(state=state) if state else uavs.exclude(state=UavState.RETIRED)


class UavUse(TypedDict):
    mission_count: int
    credentials_in_force: list[UavCredential]


if TYPE_CHECKING:
    from django_stubs_ext import WithAnnotations

    UavWithUse = WithAnnotations[Uav, UavUse]
else:
    UavWithUse = Uav


def with_use(uavs: QuerySet[Uav]) -> QuerySet[UavWithUse]:
    """Annotate UAVs with the number of missions that use each, and with the credentials in force."""
    of_today = Q(mission_uavs__mission__deleted_at=None)
    in_force = UavCredential.objects.filter(revoked_at=None).order_by("uav_id", "kind", "-pk").distinct("uav_id", "kind")
    return uavs.annotate(mission_count=Count("mission_uavs__mission", filter=of_today, distinct=True)).prefetch_related(
        Prefetch("credentials", in_force, to_attr="credentials_in_force")
    )


def numbers_by_state(uavs: QuerySet[Uav]) -> dict[str, int]:
    counted = dict(uavs.order_by().values_list("state").annotate(Count("pk")))
    return {state: counted.get(state, 0) for state in UavState.values}


def types_of_organisation(organisation: Organisation, *, text: str = "") -> QuerySet[UavType]:
    return UavType.objects.filter(organisation=organisation, name__icontains=text).annotate(uav_count=Count("uavs"))


def bases_of_organisation(organisation: Organisation, *, text: str = "") -> QuerySet[Base]:
    return Base.objects.filter(organisation=organisation, name__icontains=text).annotate(uav_count=Count("uavs"))


def missions_of_uav(uav: Uav) -> QuerySet[Mission]:
    return Mission.objects.filter(organisation=uav.organisation_id, deleted_at=None, mission_uavs__uav=uav).distinct()


def credentials_of_uav(uav: Uav) -> QuerySet[UavCredential]:
    return uav.credentials.select_related("created_by")


def last_change(subject_type: str, subject_id: int) -> AuditEntry | None:
    entries = AuditEntry.objects.filter(subject_type=subject_type, subject_id=str(subject_id)).select_related("actor")
    return entries.order_by("-recorded_at", "-pk").first()


def facts_when_deleted(organisation: Organisation, subject_type: str, subject_id: int) -> dict[str, Any] | None:
    """Return the facts of a fleet row when it was deleted; None where its last change is not a deletion."""
    entry = last_change(subject_type, subject_id)
    if entry is None or entry.action != "delete" or entry.organisation_id != organisation.pk:
        return None
    return entry.before


def figures_of(uav: Uav) -> dict[str, Any]:
    """Return the values that plans use for a UAV, by API name: its own, else its type's. Raises InvalidPerformance."""
    return {
        "max_range_m": uav.range_m,
        "cruise_speed_mps": uav.speed_mps,
        **performance_to_json(performance_of(uav)),
        "sensors": uav.sensors,
    }


def performance_of(uav: Uav) -> Performance:
    """Return a UAV's own values, else its type's; without a battery, energy is not computed. Raises InvalidPerformance."""
    return performance_with(uav.uav_type, {name: getattr(uav, name) for name in OWN_PERFORMANCE_KEYS})


def performance_with(uav_type: UavType | None, own: Mapping[str, float | None]) -> Performance:
    """Return the performance of a UAV of a type with own values; None means the type's. Raises InvalidPerformance."""
    figures = {} if uav_type is None else {name: getattr(uav_type, name) for name in PERFORMANCE_KEYS}
    mass_kg = own.get("mass_kg")
    others = {name: value for name, value in own.items() if value is not None and name != "mass_kg"}
    found = performance_from_json(figures | others)
    return found if mass_kg is None else found.with_mass(mass_kg)
