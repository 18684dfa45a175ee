"""A request with its planning context as a file, from which the plan can be made again without a database."""

import dataclasses
import json
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from inspection.geodesy import LonLat
from inspection.network.build.zone_masking import masked
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.snapshot_file import CorruptSnapshot, from_bytes, to_bytes
from inspection.network.zones.zone_index import ZoneIndex
from inspection.terrain.heights import HeightGrid
from inspection.terrain.tiled_terrain import IntArray, TiledTerrain
from inspection.zones.reach import BoolArray, HeightLimits, ZoneTable
from inspection.zones.schedule import ZoneRules
from operation.reasons import reason_from_json
from planning.airspace import box_near
from planning.context import OtherFlights, PlanningContext, PlanningRules, ResolvedTarget, Terrain
from planning.request import PlanRequest, request_from_json, request_to_json
from planning.rules import FlightRules, Manoeuvres, RoutingRules, SeparationRules
from planning.separation.separation import TimedRoute
from planning.task import task_from_json, task_to_json
from planning.trajectory.heights import FloatArray
from planning.views.photo_flight import PhotoFlight

LAYOUT = 2
ABOUT, NETWORK, ZONES, TERRAIN = "context.json", "network.npz", "zones.npz", "terrain.npz"
OTHER_FLIGHTS_S = 14 * 86_400.0  # after the departure: those of other missions that are written


class NotAContextFile(ValueError):
    """The file is no planning context, is damaged, or is of another layout."""


def write_context(path: Path, context: PlanningContext, request: PlanRequest) -> None:
    """Write all that the plan is made from; of the terrain the tiles near the mission, of other flights those of the next two weeks."""
    about = {
        "layout": LAYOUT,
        "request": request_to_json(request),
        "rules": dataclasses.asdict(context.rules),
        "graph_version": context.graph_version,
        "map_version": context.map_version,
        "targets": [_target_to_json(target) for target in context.targets],
        "deleted_targets": list(context.deleted_targets),
        "out_of_service": sorted(context.out_of_service.items()),
        "in_air": sorted(context.in_air),
        "other_flights": _flights_to_json(context.other_flights(OTHER_FLIGHTS_S)),
        "zones": {
            "names": context.zones.names,
            "limits": context.zones.limits,
            "schedules": context.zones.schedules,
            "wkb": [shape.hex() for shape in context.zones.wkb],
        },
        "has_terrain": context.terrain is not None,
    }
    tiles = None if context.terrain is None else context.terrain.around(box_near(_places(context, request)))
    with ZipFile(path, "w", ZIP_DEFLATED) as file:
        file.writestr(ABOUT, json.dumps(about))
        file.writestr(NETWORK, to_bytes(context.network), ZIP_STORED)
        zones = context.zones
        file.writestr(ZONES, _npz(ids=zones.ids, box=zones.box, floor_agl_m=zones.floor_agl_m, ceiling_agl_m=zones.ceiling_agl_m))
        if tiles is not None:
            file.writestr(TERRAIN, _npz(**_tile_arrays(tiles)))


def read_context(path: Path) -> tuple[PlanningContext, PlanRequest]:
    """Read what write_context has written. Raises NotAContextFile, or OSError."""
    try:
        with ZipFile(path) as file:
            parts = {name: file.read(name) for name in file.namelist()}
        about, network = json.loads(parts[ABOUT]), parts[NETWORK]
        if about["layout"] != LAYOUT:
            raise NotAContextFile(f"{path} has layout {about['layout']}; this version reads layout {LAYOUT}.")
        return _context(about, network, _arrays(parts[ZONES]), _arrays(parts[TERRAIN]) if about["has_terrain"] else None)
    except (BadZipFile, KeyError, TypeError, ValueError, CorruptSnapshot) as error:
        if isinstance(error, NotAContextFile):
            raise
        raise NotAContextFile(f"{path} is no planning context, or is damaged: {error}") from error


def _context(
    about: dict[str, Any], network_npz: bytes, zones: dict[str, np.ndarray], tiles: dict[str, np.ndarray] | None
) -> tuple[PlanningContext, PlanRequest]:
    rules, text = _rules(about["rules"]), about["zones"]
    network = from_bytes(network_npz, content_sha256=sha256(network_npz).hexdigest())
    table = ZoneTable(
        ids=zones["ids"],
        names=tuple(text["names"]),
        wkb=tuple(bytes.fromhex(shape) for shape in text["wkb"]),
        box=zones["box"],
        floor_agl_m=zones["floor_agl_m"],
        ceiling_agl_m=zones["ceiling_agl_m"],
        limits=tuple(HeightLimits(*limits) for limits in text["limits"]),
        schedules=tuple(text["schedules"]),
        rules=rules.zones,
    )
    whole = ZoneIndex(table.polygons, table.ids, table.names, floor_agl_m=table.floor_agl_m, ceiling_agl_m=table.ceiling_agl_m)
    indices: dict[bytes, ZoneIndex] = {}
    graphs: dict[ZoneIndex, InspectionGraph] = {}

    def zone_index(chosen: BoolArray | None) -> ZoneIndex:
        if chosen is None or chosen.all():
            return whole
        return indices.setdefault(chosen.tobytes(), whole.where(chosen))

    def cleared_of(index: ZoneIndex) -> InspectionGraph:
        if index not in graphs:
            stamps = {"version": about["graph_version"], "ground_revision": about["map_version"]}
            graphs[index] = masked(network, index, rules.linking, rules.heights, **stamps).graph
        return graphs[index]

    flights = _flights_from_json(about["other_flights"])
    context = PlanningContext(
        rules=rules,
        network=network,
        zones=table,
        cleared=cleared_of,
        zone_index=zone_index,
        terrain=None if tiles is None else _terrain(tiles),
        graph_version=about["graph_version"],
        map_version=about["map_version"],
        targets=[_target_from_json(target) for target in about["targets"]],
        deleted_targets=about["deleted_targets"],
        out_of_service=dict(about["out_of_service"]),
        in_air=frozenset(about["in_air"]),
        other_flights=lambda window_s: dataclasses.replace(
            flights, routes=tuple(route for route in flights.routes if route.take_off_s < window_s)
        ),
    )
    return context, request_from_json(about["request"])


def _rules(value: dict[str, Any]) -> PlanningRules:
    flight = value["flight"]
    return PlanningRules(
        linking=LinkingRules(**value["linking"]),
        routing=RoutingRules(**value["routing"]),
        flight=FlightRules(**{**flight, "manoeuvres": Manoeuvres(**flight["manoeuvres"])}),
        zones=ZoneRules(**value["zones"]),
        heights=FlownHeights(**value["heights"]),
        separation=SeparationRules(**value["separation"]),
    )


def _target_to_json(target: ResolvedTarget) -> dict[str, Any]:
    return {
        "target": target.target,
        "course": target.course,
        "task": task_to_json(target.task),
        "height_m": target.height_m,
        "asset": target.asset,
        "kind": target.kind,
        "photos": None if target.photos is None else target.photos.to_json(),
        "no_photos": None if target.no_photos is None else target.no_photos.to_json(),
    }


def _target_from_json(value: dict[str, Any]) -> ResolvedTarget:
    task = task_from_json(value["task"])
    if task is None:
        raise ValueError("a target has no task")
    photos, no_photos = value.get("photos"), value.get("no_photos")
    read = {
        "course": tuple(LonLat(*at) for at in value["course"]),
        "task": task,
        "photos": None if photos is None else PhotoFlight.from_json(photos),
        "no_photos": None if no_photos is None else reason_from_json(no_photos),
    }
    return ResolvedTarget(**{**value, **read})


def _flights_to_json(flights: OtherFlights) -> dict[str, Any]:
    def columns(route: TimedRoute) -> dict[str, Any]:
        fields = {field.name: getattr(route, field.name) for field in dataclasses.fields(route)}
        return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in fields.items()}

    return {"routes": [columns(route) for route in flights.routes], "untimed": flights.untimed}


def _flights_from_json(value: dict[str, Any]) -> OtherFlights:
    def route(columns: dict[str, Any]) -> TimedRoute:
        values: dict[str, Any] = {name: np.array(column) if isinstance(column, list) else column for name, column in columns.items()}
        return TimedRoute(**values)

    return OtherFlights(tuple(map(route, value["routes"])), tuple((mission, uav) for mission, uav in value["untimed"]))


def _places(context: PlanningContext, request: PlanRequest) -> list[LonLat]:
    """Where the mission begins, ends and inspects."""
    return [
        *(at for uav in request.uavs for at in (uav.position, uav.returns_to)),
        *(base.position for base in request.bases),
        *request.lost_link.rally_points,
        *(at for target in context.targets for at in target.course),
    ]


def _tile_arrays(tiles: TiledTerrain) -> dict[str, np.ndarray]:
    found = dict(tiles.grids())
    rows = np.array(sorted(found), dtype=np.int64)
    heights = {f"heights_{number}": found[row].heights_m for number, row in enumerate(rows.tolist())}
    return {"keys": tiles.keys[rows], "imports": tiles.imports[rows], "lattice": tiles.lattice[rows], "size": tiles.size[rows], **heights}


def _terrain(arrays: dict[str, np.ndarray]) -> Terrain:
    grids = {
        key: HeightGrid(west, north, step_lon, step_lat, arrays[f"heights_{number}"])
        for number, (key, (west, north, step_lon, step_lat)) in enumerate(
            zip(arrays["keys"].tolist(), arrays["lattice"].tolist(), strict=True)
        )
    }

    def grid(keys: IntArray, number: int, wanted: IntArray) -> HeightGrid | None:
        return grids[int(keys[number])]

    def heights_m(positions: FloatArray) -> FloatArray:
        return tiles.heights_at(positions).heights_m

    tiles = TiledTerrain(arrays["keys"], arrays["imports"], arrays["lattice"], arrays["size"], grid)
    return Terrain(heights_m, lambda graph: heights_m(graph.position), tiles.around)


def _npz(**arrays: Any) -> bytes:
    content = BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


def _arrays(content: bytes) -> dict[str, np.ndarray]:
    with np.load(BytesIO(content), allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}
