"""Fill an empty database with a working day: a region with terrain and zones, people, and 200 UAVs, most of them in the air.

    python deploy/load/prepare_day.py --out FOLDER                        the synthetic demo region
    python deploy/load/prepare_day.py --out FOLDER --osm region.osm.pbf   a real extract beside it, for maps and plans

Wants the database of DATABASE_URL, one of its own. Everything is made by the importers and services that people's requests come to; what
a vehicle and its gateway would say while missions are loaded and started is said by the gateway's own services. Beside the database it
writes FOLDER/day.json (mode 0600), from which working_day.py plays.
"""

import argparse
import math
import os
import secrets
import sys
from collections.abc import Iterator, Sequence
from datetime import timedelta
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import django
import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.contrib.auth.hashers import make_password  # noqa: E402 (Django first)
from django.core.management import call_command  # noqa: E402
from django.utils import timezone  # noqa: E402

from deploy.load.day.in_air import put_in_air  # noqa: E402
from deploy.load.day.site import Desk, InAir, Person, Site  # noqa: E402
from inspection.geodesy import LonLat  # noqa: E402
from inspection.models import Asset, AssetKind, GraphSnapshot  # noqa: E402
from missions.models import CredentialKind, LinkKind, Mission, Uav, UavType  # noqa: E402
from missions.services import PlanRequest, TargetRequest, UavRequest, create_mission, make_plan, plan_mission  # noqa: E402
from missions.services.approval.approval import approve_mission  # noqa: E402
from missions.services.commands.refused import Refused  # noqa: E402
from missions.services.fleet.credentials import make_credential  # noqa: E402
from missions.services.fleet.types_and_bases import create_uav_type  # noqa: E402
from missions.services.fleet.uavs import create_uav  # noqa: E402
from planning.problem import Objective  # noqa: E402
from planning.request import EndAction  # noqa: E402
from workspace.api_tokens import create_api_token  # noqa: E402
from workspace.models import Organisation, Role, User  # noqa: E402

UAVS_A_MISSION = 9
FIRST_SYSTEM = 2
SPEED_MPS = 10.0
PROGRAMS = 4
NEAR = 14  # towers about a place
ROLES = {Role.OPERATOR: 0.55, Role.VIEWER: 0.35, Role.CURATOR: 0.05, Role.ADMINISTRATOR: 0.05}
ZOOMS = (8, 10, 12, 13)  # that somebody passes on the way to a place
TOKEN_DAYS = 7
WAIT_M = 60.0  # from a tower to where its UAV stands
BESIDE_DEG = WAIT_M / 111_195.0


def make_ground(extracts: Sequence[Path]) -> None:
    """The demo region, which has terrain, and the extracts."""
    with TemporaryDirectory() as folder:
        call_command("make_demo_region", folder, stdout=StringIO())
        call_command("import_osm", f"{folder}/demo.osm.pbf", "--synthetic", stdout=StringIO())
        call_command("import_terrain", f"{folder}/demo-terrain.tif", stdout=StringIO())
        call_command("import_zones", f"{folder}/demo-zones.json", "--synthetic", stdout=StringIO())
    for extract in extracts:
        call_command("import_osm", str(extract), stdout=StringIO())
    call_command("build_graph", stdout=StringIO())


def make_users(organisation: Organisation, number: int, password: str) -> list[User]:
    """One hash for all: nobody waits for a password to be made, and each sign-in still pays for looking at it."""
    stored, people = make_password(password), []
    for role, share in ROLES.items():
        for place in range(max(2, round(number * share))):
            user = User(username=f"{role}-{place + 1:03}", role=role, organisation=organisation, password=stored)
            user.save()
            people.append(user)
    return people


def towers_by_place(count: int, seed: int) -> Iterator[list[Asset]]:
    """Towers of the demo region that lie about a place each, far places first."""
    region = Asset.objects.filter(kind=AssetKind.TOWER, subtype="tower", is_flyable=True, data_import__is_synthetic=True)
    towers = list(region.order_by("pk"))
    at = np.array([tower.centre.coords for tower in towers])
    metres = at * [111_195.0 * math.cos(math.radians(float(at[:, 1].mean()))), 111_195.0]
    for place in spread(metres, count, seed):
        nearest = np.argsort(((metres - metres[place]) ** 2).sum(axis=1))[:NEAR]
        yield [towers[number] for number in nearest.tolist()]


def spread(metres: NDArray[np.float64], count: int, seed: int) -> list[int]:
    """So many of the points, each as far as may be from those before it."""
    chosen = [int(np.random.default_rng(seed).integers(len(metres)))]
    away = ((metres - metres[chosen[0]]) ** 2).sum(axis=1)
    while len(chosen) < min(count, len(metres)):
        chosen.append(int(away.argmax()))
        away = np.minimum(away, ((metres - metres[chosen[-1]]) ** 2).sum(axis=1))
    return chosen


def beside(tower: Asset) -> LonLat:
    return LonLat(tower.centre.x, tower.centre.y - BESIDE_DEG)


def register(user: User, name: str, position: LonLat, uav_type: UavType, **values: object) -> Uav:
    reported = {"name": name, "uav_type": uav_type, "is_simulated": True, "cruise_speed_mps": SPEED_MPS, **values}
    return create_uav(organisation=user.organisation, actor=user, position=position, values=reported)


def request_of(uavs: Sequence[tuple[Uav, int | None]], targets: Sequence[Asset], *, returns: bool) -> PlanRequest:
    """Each UAV with how many targets it does at most."""
    end = EndAction.RETURN if returns else EndAction.HOVER
    asked = tuple(
        UavRequest(uav.name, LonLat(*uav.location.coords), None, uav.speed_mps, end, uav=uav.pk, most_targets=most) for uav, most in uavs
    )
    return PlanRequest(asked, tuple(TargetRequest(tower.pk) for tower in targets), Objective.TOTAL, return_to_start=returns)


def approved_mission(row: int, user: User, towers: Sequence[Asset], uav_type: UavType) -> Mission | None:
    """UAVs that stand beside every other tower of a place, with a tower each to look at; None where it may not be flown so."""
    system = FIRST_SYSTEM + row * UAVS_A_MISSION
    uavs = []
    for number, tower in enumerate(towers[:UAVS_A_MISSION]):
        facts = {"mavlink_system_id": system + number, "allows_unsigned": True}
        known = Uav.objects.filter(name=f"UAV {system + number:03}").first()
        uavs.append(known or register(user, f"UAV {system + number:03}", beside(tower), uav_type, **facts))
    request = request_of([(uav, 1) for uav in uavs], towers[:UAVS_A_MISSION], returns=True)
    draft = create_mission(organisation=user.organisation, author=user, name=f"In the air {row + 1}", request=request)
    mission = plan_mission(mission=draft, actor=user)
    try:
        approve_mission(mission=mission, actor=user)
    except Refused as refused:
        print(f"row {row + 1} is not flown: {refused}", file=sys.stderr)
        return None
    mission.refresh_from_db()
    return mission


def make_fleet(user: User, places: Iterator[list[Asset]], uav_type: UavType, uavs: int) -> list[InAir]:
    in_air: list[InAir] = []
    for row in range(-(-uavs // UAVS_A_MISSION)):
        mission = approved_mission(row, user, next(places), uav_type)
        if mission is not None:
            in_air += put_in_air(mission, user)
    return in_air


def make_desks(operators: Sequence[User], places: Iterator[list[Asset]], uav_type: UavType) -> list[Desk]:
    desks = []
    for number, operator in enumerate(operators):
        towers = next(places)
        uav = register(operator, f"Companion {number + 1:02}", beside(towers[0]), uav_type, link=LinkKind.HTTP)
        make_plan(request=request_of([(uav, None)], towers[:3], returns=True))  # raises where nobody could plan here
        token = make_credential(uav=uav, actor=operator, kind=CredentialKind.LINK_TOKEN).secret
        keys = tuple(tower.pk for tower in towers)
        desks.append(Desk(operator.username, uav.pk, token, (uav.location.x, uav.location.y), keys))
    return desks


def tiles_about(lon: float, lat: float) -> tuple[tuple[int, int, int], ...]:
    """Four a zoom, as a window shows them while somebody zooms in on a place."""
    found = []
    for zoom in ZOOMS:
        across = 2**zoom
        column = int((lon + 180.0) / 360.0 * across)
        row = int((1.0 - math.asinh(math.tan(math.radians(lat))) / math.pi) / 2.0 * across)
        found += [(zoom, column + east, row + south) for east in (0, 1) for south in (0, 1)]
    return tuple(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True, help="folder for day.json")
    parser.add_argument("--osm", type=Path, action="append", default=[], help="a real extract beside the demo region")
    parser.add_argument("--people", type=int, default=400)
    parser.add_argument("--uavs", type=int, default=200)
    parser.add_argument("--companions", type=int, default=20, help="of the UAVs: told by HTTP")
    parser.add_argument("--seed", type=int, default=11)
    options = parser.parse_args()

    began_s = perf_counter()
    options.out.mkdir(parents=True, exist_ok=True)
    call_command("migrate", verbosity=0)
    if User.objects.exists() or Uav.objects.exists():
        parser.error("there are people or UAVs in this database: the working day wants one of its own")
    if not GraphSnapshot.objects.exists():
        make_ground(options.osm)
    organisation = Organisation.objects.create(name="Working day")
    password = secrets.token_urlsafe(12)
    people = make_users(organisation, options.people, password)
    operators = [person for person in people if person.role == Role.OPERATOR]
    facts = {"name": "Day", "cruise_speed_mps": SPEED_MPS}
    uav_type = create_uav_type(organisation=organisation, actor=operators[0], values=facts)
    flown = options.uavs - options.companions
    places = towers_by_place(-(-flown // UAVS_A_MISSION) + options.companions, options.seed)
    in_air = make_fleet(operators[0], places, uav_type, flown)
    desks = make_desks(operators[: options.companions], places, uav_type)
    expires_at = timezone.now() + timedelta(days=TOKEN_DAYS)
    programs = [create_api_token(user=user, name="working day", expires_at=expires_at) for user in operators[-PROGRAMS:]]
    towers = Asset.objects.filter(kind=AssetKind.TOWER, is_flyable=True, data_import__is_synthetic=True)
    at = np.array([tower.centre.coords for tower in towers])
    site = Site(
        organisation=organisation.pk,
        password=password,
        people=tuple(Person(person.username, str(person.role)) for person in people),
        desks=tuple(desks),
        in_air=tuple(in_air),
        programs=tuple(programs),
        places=tuple(tiles_about(*desk.position) for desk in desks),
        towers=tuple(towers.values_list("pk", flat=True)),
        box=(*at.min(axis=0).tolist(), *at.max(axis=0).tolist()),
    )
    site.write(options.out)
    print(
        f"{len(people)} people, {len(in_air)} UAVs in the air, {len(desks)} with companions, {Asset.objects.count():,} assets, "
        f"in {perf_counter() - began_s:.0f} s"
    )


if __name__ == "__main__":
    main()
