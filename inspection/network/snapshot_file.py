"""A network as bytes (npz) for the database; networks and cleared graphs with their index as memory-mapped files for planners."""

import io
import json
import os
import shutil
import tempfile
from dataclasses import asdict, fields, replace
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from inspection.network.build.flyable import flyable_part, remember_flyable_part
from inspection.network.build.network import GRAPH_FIELDS, Network
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.paths.asset_places import AssetPlaces
from inspection.network.paths.contracted_graph import ContractedGraph
from inspection.network.paths.hub_labels import HubLabels
from inspection.network.paths.node_tree import NodeTree
from inspection.network.route_index import RouteIndex, asset_places, node_tree, route_index
from inspection.network.rules import FlownHeights, LinkingRules
from inspection.network.zones.zone_index import ZoneIndex

MANIFEST = "manifest.json"

Arrays = dict[str, Any]  # NumPy arrays by the names of their files


def write_folder(parent: Path, name: str, arrays: Arrays, about: dict[str, Any], *, kept: int) -> None:
    """One .npy file per array in parent/name, and the manifest with their hashes and what they are about (JSON).

    All appears whole or not at all, in place of a folder that is broken. Beside it the `kept` folders used last stay.
    """
    parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".draft-", dir=parent) as draft_name:
        draft = Path(draft_name) / "arrays"
        draft.mkdir()
        for array_name, array in arrays.items():
            np.save(draft / f"{array_name}.npy", array, allow_pickle=False)
        hashes = {path.name: _hash_of_file(path) for path in sorted(draft.iterdir())}
        (draft / MANIFEST).write_text(json.dumps({"about": about, "files": hashes}))
        target = parent / name
        try:
            draft.rename(target)
        except OSError:  # there is one already: a broken one, or another process was faster with the same
            target.rename(Path(draft_name) / "replaced")
            draft.rename(target)
    _remove_old(parent, but=name, kept=kept)


def read_folder(place: Path, about: dict[str, Any]) -> Arrays | None:
    """The arrays, memory-mapped and read-only; None when files are missing, broken or about something else."""
    try:
        manifest = json.loads((place / MANIFEST).read_bytes())
        if manifest["about"] != about:
            return None
        if any(_hash_of_file(place / name) != digest for name, digest in manifest["files"].items()):
            return None
        # Files with the same content are mapped once: where the cost of an edge is its length, half of the index is.
        mapped = {digest: _mapped(place / name) for name, digest in manifest["files"].items()}
        if json.loads((place / MANIFEST).read_bytes()) != manifest:  # others took the place between the look and the mapping
            return None
        os.utime(place)
        return {name.removesuffix(".npy"): mapped[digest] for name, digest in manifest["files"].items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _mapped(path: Path) -> NDArray[np.generic]:
    mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    plain: NDArray[np.generic] = np.asarray(mapped)
    return plain


def _hash_of_file(path: Path) -> str:
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


def _remove_old(parent: Path, *, but: str, kept: int) -> None:
    """Keep what was used last, and this one; remove drafts that killed processes left before any of it."""
    folders = sorted((path for path in parent.iterdir() if path.is_dir() and not path.name.startswith(".")), key=_used_s, reverse=True)
    for path in folders[kept:]:
        if path.name != but:
            shutil.rmtree(path, ignore_errors=True)
    oldest_s = min((_used_s(path) for path in folders[:kept]), default=0.0)
    for path in parent.glob(".draft-*"):
        if _used_s(path) < oldest_s:
            shutil.rmtree(path, ignore_errors=True)


def _used_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return float("inf")


LAYOUT = 5  # of the stored arrays and of the files; what has another layout is made anew
FLYABLE = "flyable."  # begins the names of the flyable part's files, where it is not the whole graph
NETWORKS, CLEARED = "networks", "cleared"
KEPT_NETWORKS, MAX_MASKED_FILES = 3, 8
NETWORK_FIELDS = [field.name for field in fields(Network)]

Part = TypeVar("Part", ContractedGraph, HubLabels, NodeTree, AssetPlaces)


class CorruptSnapshot(Exception):
    """The bytes are not those that were stored."""


def to_bytes(graph: Network | InspectionGraph) -> bytes:
    """The arrays as a compressed npz, with its zones for a cleared graph; the same arrays always give the same bytes."""
    arrays = _arrays(graph)
    if isinstance(graph, InspectionGraph):
        arrays |= {
            "zone_id": graph.zone_id,
            "zone_wkb": np.frombuffer(b"".join(graph.zone_wkb), dtype=np.uint8),
            "zone_wkb_end": np.cumsum([len(wkb) for wkb in graph.zone_wkb], dtype=np.int64),
            "zone_name": np.frombuffer(json.dumps(graph.zone_name).encode(), dtype=np.uint8),
        }
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **arrays)
    return stream.getvalue()


def from_bytes(content: bytes, *, content_sha256: str) -> Network:
    """The network from its npz. Raises CorruptSnapshot when the content is not what its hash says."""
    if sha256(content).hexdigest() != content_sha256:
        raise CorruptSnapshot(content_sha256)
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        return Network(**{name: stored[name] for name in NETWORK_FIELDS})


def write_network(folder: Path, network: Network, *, content_sha256: str) -> None:
    """The network beside others, of which few are kept; files of earlier layouts go."""
    write_folder(folder / NETWORKS, content_sha256, _arrays(network), _about(content_sha256), kept=KEPT_NETWORKS)
    for path in folder.iterdir():
        if path.name.isdigit() or path.name.startswith(".draft-"):
            shutil.rmtree(path, ignore_errors=True)


def read_network(folder: Path, *, content_sha256: str) -> Network | None:
    """The network, memory-mapped and read-only; None when the files are missing, broken or of another layout."""
    arrays = read_folder(folder / NETWORKS / content_sha256, _about(content_sha256))
    return None if arrays is None else Network(**{name: arrays[name] for name in NETWORK_FIELDS})


def key_of_masked(content_sha256: str, zones: ZoneIndex, rules: LinkingRules, heights: FlownHeights, tallest_m: float) -> str:
    """What tells the files of cleared graphs apart: the network, where the zones are, and every figure that the clearing reads."""
    figures = json.dumps([LAYOUT, content_sha256, zones.digest, asdict(rules), asdict(heights), tallest_m], sort_keys=True)
    return sha256(figures.encode()).hexdigest()


def write_masked(folder: Path, graph: InspectionGraph, *, key: str, tallest_m: float) -> None:
    """A cleared graph without its zones, with the part that can be flown over where nothing is taller, and the index of that."""
    arrays = _arrays(graph)
    flyable = flyable_part(graph, tallest_m)
    arrays |= _index_arrays(flyable)
    if flyable is not graph:
        arrays |= {FLYABLE + name: array for name, array in _arrays(flyable).items()}
        arrays |= _arrays_of("places", asset_places(graph))
    write_folder(folder / CLEARED, key, arrays, _about(key), kept=MAX_MASKED_FILES)


def read_masked(
    folder: Path, *, key: str, zones: ZoneIndex, version: int, ground_revision: int, tallest_m: float
) -> InspectionGraph | None:
    """The graph with its index, all memory-mapped and read-only; None when the files are missing, broken or of another layout."""
    arrays = read_folder(folder / CLEARED / key, _about(key))
    if arrays is None:
        return None
    graph = flyable = InspectionGraph(
        version=version,
        ground_revision=ground_revision,
        zone_wkb=zones.wkb,
        zone_id=zones.ids,
        zone_name=zones.names,
        **{name: arrays[name] for name in GRAPH_FIELDS},
    )
    if any(name.startswith(FLYABLE) for name in arrays):
        own: Arrays = {name: arrays[FLYABLE + name] for name in GRAPH_FIELDS}
        flyable = replace(graph, **own)
        asset_places.remember(graph, _part(AssetPlaces, arrays, "places"))
    _remember_index(flyable, arrays)
    remember_flyable_part(graph, tallest_m, flyable)
    return graph


def _about(key: str) -> dict[str, object]:
    return {"layout": LAYOUT, "key": key}


def _index_arrays(graph: InspectionGraph) -> Arrays:
    index = route_index(graph)
    return (
        _arrays_of("condensed", index.contracted)
        | _arrays_of("labels", index.labels)
        | _arrays_of("tree", node_tree(graph))
        | _arrays_of("flyable_places", asset_places(graph))
    )


def _remember_index(graph: InspectionGraph, arrays: Arrays) -> None:
    route_index.remember(graph, RouteIndex(_part(ContractedGraph, arrays, "condensed"), _part(HubLabels, arrays, "labels")))
    node_tree.remember(graph, _part(NodeTree, arrays, "tree"))
    asset_places.remember(graph, _part(AssetPlaces, arrays, "flyable_places"))


def _arrays_of(name: str, part: ContractedGraph | HubLabels | NodeTree | AssetPlaces) -> Arrays:
    return {f"{name}.{field}": array for field, array in part._asdict().items()}


def _part(kind: type[Part], arrays: Arrays, name: str) -> Part:
    return kind(*(arrays[f"{name}.{field}"] for field in kind._fields))


def _arrays(graph: Network | InspectionGraph) -> Arrays:
    return {name: getattr(graph, name) for name in (NETWORK_FIELDS if isinstance(graph, Network) else GRAPH_FIELDS)}
