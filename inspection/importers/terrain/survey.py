"""What is in a terrain file, counted while it is read."""

from typing import Any

import numpy as np

from inspection.importers.terrain.raster import Block


class Survey:
    """Counts the posts of blocks once each, though blocks share their edges."""

    def __init__(self) -> None:
        self.blocks = self.posts = self.declared_voids = self.undeclared_voids = 0
        self.lowest_m, self.highest_m = np.inf, -np.inf
        self._extent = [np.inf, np.inf, -np.inf, -np.inf]

    def add(self, block: Block) -> None:
        self.posts += block.posts
        self.declared_voids += block.declared_voids
        self.undeclared_voids += block.undeclared_voids
        if block.grid is None:
            return
        self.blocks += 1
        self.lowest_m = min(self.lowest_m, float(np.nanmin(block.grid.heights_m)))
        self.highest_m = max(self.highest_m, float(np.nanmax(block.grid.heights_m)))
        west, south, east, north = block.grid.extent
        least, most = self._extent[:2], self._extent[2:]
        self._extent = [min(least[0], west), min(least[1], south), max(most[0], east), max(most[1], north)]

    @property
    def voids(self) -> int:
        return self.declared_voids + self.undeclared_voids

    def counts(self) -> dict[str, Any]:
        """Of a file with at least one height."""
        return {
            "blocks": self.blocks, "posts": self.posts, "voids": self.voids, "undeclared_voids": self.undeclared_voids,
            "lowest_m": round(self.lowest_m, 2), "highest_m": round(self.highest_m, 2), "extent": self._extent,
        }  # fmt: skip

    def void_sentence(self) -> str:
        """Empty where there is none."""
        if not self.voids:
            return ""
        words = f"{self.voids} of {self.posts} posts are void ({100 * self.voids / self.posts:.2g} %)"
        if self.undeclared_voids:
            words += f", {self.undeclared_voids} of them without being declared"
        return f"{words}. An older model fills them where it reaches; elsewhere the ground stays unknown. Nothing is made up."
