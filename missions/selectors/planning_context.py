"""The planning context of a request, read from rows at once."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from django.conf import settings
from django.utils.translation import gettext as _

from inspection.geodesy import LonLat
from inspection.selectors.ground import DatasetVersion
from inspection.selectors.planning import PlanningGround, heights_at, planning_read, terrain_at
from inspection.selectors.terrain import node_ground_m, tiles_around
from inspection.terrain.profile import profile_under
from missions.hooks.in_air import uavs_in_the_air
from missions.models import UavState
from missions.selectors.fleet import bases_of_organisation, states_out_of_service
from missions.selectors.flights import flights_at_the_same_time
from missions.selectors.photo_flights import OnPhotos, with_photo_flights
from missions.selectors.resolved_targets import NamedTarget, resolved_targets, whole_assets
from planning.airspace import Airspace, airspace_on, zone_choice
from planning.context import OtherFlights, PlanningContext, PlanningRules, ResolvedTarget, Terrain
from planning.request import BaseRequest, EndAction, InvalidRequest, PlanRequest
from planning.trajectory.heights import GroundModel
from workspace.models import Organisation


def planning_rules() -> PlanningRules:
    """Return the limits from the settings that a plan keeps."""
    return PlanningRules(
        linking=settings.GRAPH_RULES,
        routing=settings.ROUTING_RULES,
        flight=settings.FLIGHT_RULES,
        zones=settings.ZONE_RULES,
        heights=settings.FLOWN_HEIGHTS,
        separation=settings.SEPARATION_RULES,
    )


def _says_nothing(planned: int, asked: int) -> None:
    pass


def read_targets(
    request: PlanRequest, on_photos: OnPhotos = _says_nothing
) -> tuple[PlanningGround, list[NamedTarget], list[int]]:  # fmt: skip
    """Return the current map data, the targets on it, and the targets whose asset has been deleted. Raises InvalidRequest.

    Photos that are not planned yet are planned, which takes seconds for each target: on_photos is called before each.
    """
    read = planning_read(whole_assets(request.targets))
    targets, deleted = resolved_targets(request.targets, read.points)
    ground = read.ground()
    return ground, with_photo_flights(targets, ground.dataset_version, on_photos), deleted


def terrain_under(dataset_version: DatasetVersion) -> GroundModel | None:
    """Return the terrain under routes over this dataset version; None without a terrain model."""
    heights_m = heights_at(dataset_version)
    if heights_m is None:
        return None
    return GroundModel(heights_m, partial(profile_under, around=partial(tiles_around, dataset_version=dataset_version)))


def planning_context(
    request: PlanRequest | None, ground: PlanningGround, targets: Sequence[ResolvedTarget] = (), deleted_targets: Sequence[int] = ()
) -> PlanningContext:
    """Return the planning context of a request over this map data; without a request it has no fleet. Raises NoGraph."""
    dataset_version = ground.dataset_version
    terrain_dataset_version, heights_m = terrain_at(dataset_version), heights_at(dataset_version)  # version before any height is read
    stored = [uav.uav for uav in request.uavs if uav.uav is not None] if request is not None else []
    in_air = frozenset(uavs_in_the_air(stored))
    return PlanningContext(
        rules=planning_rules(),
        network=ground.network(),
        zones=ground.table,
        cleared=ground.graph,
        zone_index=ground.zones,
        terrain=None
        if heights_m is None
        else Terrain(
            heights_m,
            lambda graph: node_ground_m(graph, terrain_dataset_version),
            lambda box: tiles_around(box, dataset_version),
        ),
        graph_version=0 if ground.snapshot is None else ground.snapshot[0],
        map_version=dataset_version[0],
        targets=targets,
        deleted_targets=deleted_targets,
        out_of_service=_out_of_service(stored, in_air),
        in_air=in_air,
        other_flights=lambda window_s: _other_flights(request, window_s),
    )


def _out_of_service(stored: Sequence[int], in_air: frozenset[int]) -> dict[int, str]:
    """Return why UAVs cannot be planned. One in the air can be, whatever it lacks: it needs a way on, and a way down."""
    if not stored:
        return {}
    return {key: state for key, state in states_out_of_service(stored).items() if key not in in_air or state in UavState.values}


def _other_flights(request: PlanRequest | None, window_s: float) -> OtherFlights:
    """Return other flights of the window. A plan without departure cannot be deconflicted; it gets a departure before it is flown."""
    if request is None or request.departs_at is None or request.organisation is None:
        return OtherFlights()
    from_s = request.departs_at.timestamp()
    return flights_at_the_same_time(request.organisation, from_s, from_s + window_s, but=request.mission)


def current_airspace(request: PlanRequest | None = None, *, is_by_length: bool = False) -> Airspace:
    """Return the airspace with all current zones, or with those that can be in force while the request is flown. Raises NoGraph."""
    context = planning_context(request, planning_read().ground())
    chosen = None if request is None else zone_choice(context.zones, request.departs_at, context.rules.flight).widest
    return airspace_on(context, chosen, is_by_length=is_by_length)


def with_bases(request: PlanRequest, organisation: Organisation) -> PlanRequest:
    """Return the request with the organisation's bases if a UAV is to land at one. Raises InvalidRequest if there is none."""
    landing = [uav for uav in range(len(request.uavs)) if request.end_action(uav) is EndAction.BASE]
    if not landing:
        return replace(request, bases=())
    bases = stored_bases(organisation)
    if not bases:
        fault = _("%(uav)s is to land at a base, but there is none. Add one to the fleet, or choose another end.")
        raise InvalidRequest({f"uavs.{uav}.end_action": fault % {"uav": request.uavs[uav].name} for uav in landing})
    return replace(request, bases=bases)


def stored_bases(organisation: Organisation) -> tuple[BaseRequest, ...]:
    rows = bases_of_organisation(organisation).order_by("name", "pk")
    return tuple(BaseRequest(row.name, LonLat(*row.location.coords)) for row in rows)
