"""How high the deck of a bridge lies, where nobody has measured it."""

import re
from collections.abc import Mapping

import numpy as np

from inspection.geodesy.wgs84 import FloatArray

LAYER_M = 6.5  # a road's or railway's free height below a bridge, with the deck
MOST_LAYERS = 5
_LAYER = re.compile(r"-?[0-9]{1,3}")


def layer_of(tags: Mapping[str, str]) -> int:
    """How many things lie below it: 1 if it is not stated."""
    stated = _LAYER.fullmatch(tags.get("layer", "").strip())
    return min(max(int(stated[0]), 1), MOST_LAYERS) if stated else 1


def deck_amsl_m(ground_m: FloatArray, layer: int) -> float:
    """Level, no lower than the highest ground at the bridge's edge, and with a layer's room over the lowest. ground_m of shape (n,)."""
    return float(max(np.max(ground_m), np.min(ground_m) + layer * LAYER_M))
