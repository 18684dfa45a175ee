"""A graph as bytes (npz) for the database, and with its index as memory-mapped files for planners."""

import io
import json
import math
import shutil
import tempfile
from dataclasses import fields, replace
from hashlib import file_digest, sha256
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from inspection.graph.asset_places import AssetPlaces
from inspection.graph.condensed import CondensedGraph
from inspection.graph.flyable import flyable_part, remember_flyable_part
from inspection.graph.hub_labels import HubLabels
from inspection.graph.inspection_graph import InspectionGraph
from inspection.graph.node_tree import NodeTree
from inspection.graph.route_index import RouteIndex, asset_places, node_tree, route_index

MANIFEST = "manifest.json"
LAYOUT = 2  # of the files; a folder of another layout is written anew
FLYABLE = "flyable."  # begins the names of the flyable part's files, where it is not the whole graph
KEPT_FOLDERS = 4
ARRAY_FIELDS = [
    field.name for field in fields(InspectionGraph) if field.name not in {"version", "ground_revision", "zone_wkb", "zone_name"}
]

Arrays = dict[str, Any]  # NumPy arrays by the names of their files
Part = TypeVar("Part", CondensedGraph, HubLabels, NodeTree, AssetPlaces)


class CorruptSnapshot(Exception):
    """The bytes are not those that were stored."""


def to_bytes(graph: InspectionGraph) -> bytes:
    """The arrays as a compressed npz; the same graph always gives the same bytes."""
    stream = io.BytesIO()
    np.savez_compressed(stream, allow_pickle=False, **_arrays(graph))
    return stream.getvalue()


def from_bytes(content: bytes, *, content_sha256: str, version: int, ground_revision: int) -> InspectionGraph:
    """The graph from its npz. Raises CorruptSnapshot when the content is not what its hash says."""
    return _graph(_checked_arrays(content, content_sha256), version, ground_revision)


def write_cache(folder: Path, content: bytes, *, content_sha256: str, version: int, tallest_m: float = math.inf) -> None:
    """Unpack a snapshot into folder/<version>/: one .npy file per array, and the manifest with their hashes.

    The part that can be flown over where nothing is taller than tallest_m, and the index that planners ask of it, are made here and
    lie beside it. All appears whole or not at all, in place of one that is broken. Folders of much older versions are removed.
    """
    arrays = _checked_arrays(content, content_sha256)
    graph = _graph(arrays, version, 0)
    flyable = flyable_part(graph, tallest_m)
    arrays |= _index_arrays(flyable)
    if flyable is not graph:
        arrays |= {FLYABLE + name: getattr(flyable, name) for name in ARRAY_FIELDS}
        arrays |= _arrays_of("places", asset_places(graph))
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".draft-", dir=folder) as draft_name:
        draft = Path(draft_name) / "graph"
        draft.mkdir()
        for name, array in arrays.items():
            np.save(draft / f"{name}.npy", array, allow_pickle=False)
        hashes = {path.name: _hash_of_file(path) for path in sorted(draft.iterdir())}
        (draft / MANIFEST).write_text(
            json.dumps({"layout": LAYOUT, "tallest_m": tallest_m, "content_sha256": content_sha256, "files": hashes})
        )
        target = folder / str(version)
        try:
            draft.rename(target)
        except OSError:  # there is one already: a broken one, or another process was faster with the same
            target.rename(Path(draft_name) / "replaced")
            draft.rename(target)
    _remove_old(folder, but=version)


def read_cache(
    folder: Path, *, content_sha256: str, version: int, ground_revision: int, tallest_m: float = math.inf
) -> InspectionGraph | None:
    """The graph with its index, all memory-mapped and read-only.

    None when the files are missing, broken, of another snapshot or for another height.
    """
    place = folder / str(version)
    try:
        manifest = json.loads((place / MANIFEST).read_bytes())
        if (manifest["layout"], manifest["tallest_m"], manifest["content_sha256"]) != (LAYOUT, tallest_m, content_sha256):
            return None
        if any(_hash_of_file(place / name) != digest for name, digest in manifest["files"].items()):
            return None
        # Files with the same content are mapped once: where the cost of an edge is its length, half of the index is.
        mapped = {digest: _mapped(place / name) for name, digest in manifest["files"].items()}
        if json.loads((place / MANIFEST).read_bytes()) != manifest:  # another snapshot took the place between the look and the mapping
            return None
        arrays = {name.removesuffix(".npy"): mapped[digest] for name, digest in manifest["files"].items()}
        graph = flyable = _graph(arrays, version, ground_revision)
        if any(name.startswith(FLYABLE) for name in arrays):
            own: Arrays = {name: arrays[FLYABLE + name] for name in ARRAY_FIELDS}
            flyable = replace(graph, **own)
            asset_places.remember(graph, _part(AssetPlaces, arrays, "places"))
        _remember_index(flyable, arrays)
        remember_flyable_part(graph, tallest_m, flyable)
        return graph
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _index_arrays(graph: InspectionGraph) -> Arrays:
    index = route_index(graph)
    return (
        _arrays_of("condensed", index.condensed)
        | _arrays_of("labels", index.labels)
        | _arrays_of("tree", node_tree(graph))
        | _arrays_of("flyable_places", asset_places(graph))
    )


def _remember_index(graph: InspectionGraph, arrays: Arrays) -> None:
    route_index.remember(graph, RouteIndex(_part(CondensedGraph, arrays, "condensed"), _part(HubLabels, arrays, "labels")))
    node_tree.remember(graph, _part(NodeTree, arrays, "tree"))
    asset_places.remember(graph, _part(AssetPlaces, arrays, "flyable_places"))


def _arrays_of(name: str, part: CondensedGraph | HubLabels | NodeTree | AssetPlaces) -> Arrays:
    return {f"{name}.{field.name}": getattr(part, field.name) for field in fields(part)}


def _part(kind: type[Part], arrays: Arrays, name: str) -> Part:
    return kind(**{field.name: arrays[f"{name}.{field.name}"] for field in fields(kind)})


def _arrays(graph: InspectionGraph) -> Arrays:
    arrays: Arrays = {name: getattr(graph, name) for name in ARRAY_FIELDS}
    ends = np.cumsum([len(wkb) for wkb in graph.zone_wkb], dtype=np.int64)
    arrays["zone_wkb"] = np.frombuffer(b"".join(graph.zone_wkb), dtype=np.uint8)
    arrays["zone_wkb_end"] = ends.astype(np.int64)
    arrays["zone_name"] = np.frombuffer(json.dumps(graph.zone_name).encode(), dtype=np.uint8)
    return arrays


def _graph(arrays: Arrays, version: int, ground_revision: int) -> InspectionGraph:
    ends = arrays["zone_wkb_end"].tolist()
    wkb = arrays["zone_wkb"].tobytes()
    return InspectionGraph(
        version=version,
        ground_revision=ground_revision,
        zone_wkb=tuple(wkb[begin:end] for begin, end in zip([0, *ends], ends, strict=False)),
        zone_name=tuple(json.loads(arrays["zone_name"].tobytes())),
        **{name: arrays[name] for name in ARRAY_FIELDS},
    )


def _checked_arrays(content: bytes, content_sha256: str) -> Arrays:
    if sha256(content).hexdigest() != content_sha256:
        raise CorruptSnapshot(content_sha256)
    with np.load(io.BytesIO(content), allow_pickle=False) as stored:
        return {name: stored[name] for name in stored.files}


def _mapped(path: Path) -> NDArray[np.generic]:
    mapped = np.load(path, mmap_mode="r", allow_pickle=False)
    plain: NDArray[np.generic] = np.asarray(mapped)
    return plain


def _hash_of_file(path: Path) -> str:
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


def _remove_old(folder: Path, *, but: int) -> None:
    """Keep the newest versions and this one, which after a restore is older; remove drafts that killed processes left before them."""
    versions = sorted((path for path in folder.iterdir() if path.name.isdigit()), key=lambda path: int(path.name), reverse=True)
    for path in versions[KEPT_FOLDERS:]:
        if path.name != str(but):
            shutil.rmtree(path, ignore_errors=True)
    oldest_s = min((_modified_s(path) for path in versions[:KEPT_FOLDERS]), default=0.0)
    for path in folder.glob(".draft-*"):
        if _modified_s(path) < oldest_s:
            shutil.rmtree(path, ignore_errors=True)


def _modified_s(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except FileNotFoundError:
        return float("inf")
