"""Tiles of far zooms, kept in the cache: they take longest to make, there are few of them, and everybody asks for the same."""

import contextlib

from django.core.cache import cache

from inspection.selectors.tiles import vector_tile
from workspace.cache_absence import CACHE_AWAY

LAST_KEPT_ZOOM = 11
KEPT_S = 3_600


def tile_of_edition(zoom: int, column: int, row: int, edition: str | None) -> bytes:
    """The tile of the ground as it is now. Raises NoSuchTile.

    `edition` is another text after each change of the ground; with None nothing is kept.
    """
    if edition is None or zoom > LAST_KEPT_ZOOM:
        return vector_tile(zoom, column, row)
    key = f"tile:{edition}:{zoom}/{column}/{row}"
    with contextlib.suppress(*CACHE_AWAY):
        if (kept := cache.get(key)) is not None:
            return bytes(kept)
    tile = vector_tile(zoom, column, row)
    with contextlib.suppress(*CACHE_AWAY):
        cache.set(key, tile, KEPT_S)
    return tile
