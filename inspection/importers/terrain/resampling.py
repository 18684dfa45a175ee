"""Places the posts of a GeoTIFF in longitude and latitude: unchanged, or resampled if its system is a different one."""

import math
import warnings

import numpy as np
from pyproj import CRS, Transformer, network
from pyproj.exceptions import ProjError
from pyproj.transformer import TransformerGroup

from inspection.geodesy.wgs84 import FloatArray, distance_m
from inspection.importers.terrain.geotiff import MAX_POSTS, GeoTiff
from inspection.importers.terrain.raster import PostKind, Raster, TerrainFileError, Window
from inspection.terrain.heights import HeightGrid

SAME_DEG = 2e-5  # some 2 m: ETRS89 and similar ones are treated as WGS 84
DEGREE_M = 111_320.0  # of latitude
MAX_CONCURRENT = 4_000_000  # posts of the file under one block
_EDGE_PLACES = 41
_NEXT_TO_POLE = 0.05  # cosine of the latitude at which steps in longitude stop growing
_WGS84 = CRS.from_epsg(4326)

network.set_network_enabled(False)


class PlacedAsItStands:
    """A GeoTIFF in longitude and latitude; see raster.Raster."""

    def __init__(self, tiff: GeoTiff) -> None:
        self._tiff = tiff
        self.width, self.height = tiff.width, tiff.height
        self.west_deg, self.north_deg, self.step_lon_deg, self.step_lat_deg = tiff.x, tiff.y, tiff.step_x, tiff.step_y

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        return self._tiff.window(row, column, rows, columns)


class SampledAnew:
    """A GeoTIFF in another system, resampled on a grid of longitude and latitude of the same resolution; see raster.Raster."""

    def __init__(self, tiff: GeoTiff, transformer: Transformer) -> None:
        self._tiff = tiff
        self._transformer = transformer
        edge = self._edge()
        (west, south), (east, north) = edge.min(axis=0), edge.max(axis=0)
        step_m = self._step_m()
        self.step_lat_deg = step_m / DEGREE_M
        self.step_lon_deg = self.step_lat_deg / max(math.cos(math.radians((south + north) / 2)), _NEXT_TO_POLE)
        self.west_deg, self.north_deg = float(west), float(north)
        self.width = int((east - west) / self.step_lon_deg) + 2
        self.height = int((north - south) / self.step_lat_deg) + 2
        if self.width * self.height > 2 * MAX_POSTS:
            raise TerrainFileError("In longitude and latitude the GeoTIFF would have too many posts. Cut it into parts.")

    def window(self, row: int, column: int, rows: int, columns: int) -> Window:
        lon = self.west_deg + (column + np.arange(columns)) * self.step_lon_deg
        lat = self.north_deg - (row + np.arange(rows)) * self.step_lat_deg
        grid = np.column_stack([np.tile(lon, rows), np.repeat(lat, columns)])
        x, y = self._transformer.transform(grid[:, 0], grid[:, 1], direction="INVERSE")
        at = np.column_stack([(np.asarray(x) - self._tiff.x) / self._tiff.step_x, (self._tiff.y - np.asarray(y)) / self._tiff.step_y])
        inside = (
            np.isfinite(at).all(axis=1)
            & (at >= -1e-6).all(axis=1)
            & (at <= np.array([self._tiff.width - 1, self._tiff.height - 1]) + 1e-6).all(axis=1)
        )
        heights = np.full(len(at), np.nan, dtype=np.float32)
        kinds = np.full(len(at), PostKind.OUTSIDE, dtype=np.uint8)
        if inside.any():
            heights[inside], kinds[inside] = self._sampled(at[inside])
        return Window(heights.reshape(rows, columns), kinds.reshape(rows, columns))

    def _sampled(self, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return heights and kinds at (column, row) of the file."""
        left, top = np.clip(np.floor(at.min(axis=0)), 0, None).astype(int).tolist()
        right, bottom = np.minimum(np.floor(at.max(axis=0)).astype(int) + 1, [self._tiff.width - 1, self._tiff.height - 1]).tolist()
        rows, columns = bottom - top + 1, right - left + 1
        if rows * columns > MAX_CONCURRENT:
            raise TerrainFileError("The GeoTIFF's system is too distorted here. Convert it first: gdalwarp -t_srs EPSG:4326")
        window = self._tiff.window(top, left, rows, columns)
        heights = HeightGrid(left, -top, 1.0, 1.0, window.heights_m).sample(at * [1.0, -1.0])
        nearest = np.clip(np.rint(at - [left, top]).astype(int), 0, [columns - 1, rows - 1])
        kinds = window.kinds[nearest[:, 1], nearest[:, 0]]
        beside = np.isnan(heights) & (kinds == PostKind.HEIGHT)  # a known post with a void among its interpolation neighbours
        return heights, np.where(np.isnan(heights), np.where(beside, PostKind.DECLARED_VOID, kinds), PostKind.HEIGHT)

    def _edge(self) -> FloatArray:
        share = np.linspace(0, 1, _EDGE_PLACES)
        x, y = (
            self._tiff.x + share * (self._tiff.width - 1) * self._tiff.step_x,
            self._tiff.y - share * (self._tiff.height - 1) * self._tiff.step_y,
        )
        grid = np.array([(a, b) for a in x for b in y])
        lon, lat = self._transformer.transform(grid[:, 0], grid[:, 1])
        edge = np.column_stack([lon, lat])
        if not np.isfinite(edge).all() or np.ptp(edge[:, 0]) > 180:
            raise TerrainFileError(
                "The GeoTIFF's positions are not all where its reference system is used, or it lies across the 180th meridian."
            )
        return edge

    def _step_m(self) -> float:
        """Return the distance between posts in the middle of the file, on the ground."""
        x, y = self._tiff.x + self._tiff.width // 2 * self._tiff.step_x, self._tiff.y - self._tiff.height // 2 * self._tiff.step_y
        lon, lat = self._transformer.transform([x, x + self._tiff.step_x, x], [y, y, y + self._tiff.step_y])
        places = np.column_stack([lon, lat])
        return float(distance_m(places[[0, 0]], places[[1, 2]]).min())


def placed(tiff: GeoTiff) -> tuple[Raster, list[str]]:
    """Return the raster in longitude and latitude, and notes for users about the conversion. Raises TerrainFileError."""
    raster, notes = _placed(tiff)
    west, north = raster.west_deg, raster.north_deg
    east, south = west + (raster.width - 1) * raster.step_lon_deg, north - (raster.height - 1) * raster.step_lat_deg
    if not (west >= -180.5 and east <= 180.5 and north <= 90.5 and south >= -90.5):
        raise TerrainFileError("The GeoTIFF reaches beyond longitude ±180 or latitude ±90.")
    return raster, notes


def _placed(tiff: GeoTiff) -> tuple[Raster, list[str]]:
    if tiff.system.equals(_WGS84, ignore_axis_order=True):
        return PlacedAsItStands(tiff), []
    try:
        with warnings.catch_warnings(action="ignore"):  # about a better one that is not installed: the notes state the accuracy of this one
            group = TransformerGroup(tiff.system, _WGS84, always_xy=True, allow_ballpark=True)
        transformer = group.transformers[0]
        if tiff.system.is_geographic and _is_as_wgs84(tiff, transformer):
            return PlacedAsItStands(tiff), [f"{tiff.system.name} is taken for WGS 84, from which it differs by less than 2 m."]
        raster = SampledAnew(tiff, transformer)
    except (ProjError, IndexError) as error:
        raise TerrainFileError(f"Nothing is known that leads from {tiff.system.name} to WGS 84.") from error
    accuracy_m = transformer.accuracy
    notes = [
        f"The file is in {tiff.system.name}: its heights are sampled anew, between its posts, every {raster.step_lat_deg * DEGREE_M:.3g} m."
    ]
    if accuracy_m is None or accuracy_m < 0:
        notes.append("How exact its places are in WGS 84 is not known.")
    elif accuracy_m > 2:
        notes.append(f"Its places in WGS 84 may be {accuracy_m:.3g} m off.")
    return raster, notes


def _is_as_wgs84(tiff: GeoTiff, transformer: Transformer) -> bool:
    x, y = tiff.x + np.array([0, tiff.width - 1]) * tiff.step_x, tiff.y - np.array([0, tiff.height - 1]) * tiff.step_y
    lon, lat = transformer.transform(x, y)
    return bool(np.isfinite([*lon, *lat]).all() and max(np.abs(lon - x).max(), np.abs(lat - y).max()) < SAME_DEG)
