"""The likely height of a bridge's deck, and what is assumed of its slab, piers and abutments. Pure."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from inspection.geodesy.wgs84 import FloatArray

LAYER_M = 6.5  # clearance under a bridge over a road or railway, deck included
MAX_LAYERS = 5
SLAB_M = 1.4
PIER_EVERY_M, PIER_M = 30.0, 1.4  # along the bridge: between piers, and of each
ABUTMENT_INSET_M = 1.5  # from the end of the outline
PIER_SHARE, PIER_HALF_M = 0.55, 6.0  # of half of the deck's width, and at most: of half of a pier's
TALL_STRUCTURES = {  # values of tags of bridges with pylons, arches or a lift above their deck
    "bridge": {"cable-stayed", "movable", "suspension"},
    "bridge:movable": {"bascule", "drawbridge", "lift"},
    "bridge:structure": {"arch", "cable-stayed", "simple-suspension", "suspension"},
    "bridge:support": {"pylon"},
}
PYLON_SHARE, ARCH_SHARE = 0.25, 0.1  # of the length of a bridge: how far what stands above its deck may rise; most arches are below it
_LAYER = re.compile(r"-?[0-9]{1,3}")


def layer_of(tags: Mapping[str, str]) -> int:
    """Return the number of layers below it; 1 if it is not stated."""
    stated = _LAYER.fullmatch(tags.get("layer", "").strip())
    return min(max(int(stated[0]), 1), MAX_LAYERS) if stated else 1


def deck_amsl_m(ground_m: FloatArray, layer: int) -> float:
    """Return a level deck height: at least the highest terrain at its edge, and layer clearances over the lowest. ground_m (n,)."""
    return float(max(np.max(ground_m), np.min(ground_m) + layer * LAYER_M))


def has_tall_structure(tags: Sequence[Mapping[str, str]]) -> bool:
    """Return whether pylons, arches or a lift may stand above a bridge's deck. tags: of the bridge and of each way on it."""
    return any(
        value.strip().lower().replace("_", "-") in TALL_STRUCTURES[key]
        for own in tags for key in TALL_STRUCTURES.keys() & own.keys() for value in str(own[key]).split(";")
    )  # fmt: skip


def tall_share(tags: Sequence[Mapping[str, str]]) -> float:
    """Return how high what stands above a bridge's deck may be, as a share of its length; 0 where nothing tall is known to stand there."""
    if not has_tall_structure(tags):
        return 0.0
    but_arches = [{key: value for key, value in own.items() if value != "arch"} for own in tags]
    return PYLON_SHARE if has_tall_structure(but_arches) else ARCH_SHARE


def deck_of(ground_m: FloatArray, height_m: float | None, tags: Sequence[Mapping[str, str]]) -> tuple[float, str]:
    """Return the height [m] of a bridge's deck, and what it is taken from: "tag" or "layer".

    ground_m (n,): the terrain at the corners of its outline; height_m: of its top above ground, as tagged, which is that of its deck unless
    something tall stands on it; tags: of the bridge and of each way on it.
    """
    if height_m is not None and not has_tall_structure(tags):
        return float(np.mean(ground_m)) + height_m, "tag"
    return deck_amsl_m(ground_m, layer_of(next(filter(None, tags), {}))), "layer"
