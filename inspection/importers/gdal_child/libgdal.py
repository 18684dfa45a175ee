"""The functions of libgdal that the child calls, by ctypes. One driver is registered; GDALAllRegister is never called."""

import ctypes
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint, c_void_p
from typing import Any

REGISTER = {
    "GTiff": "GDALRegister_GTiff", "GML": "RegisterOGRGML", "FlatGeobuf": "RegisterOGRFlatGeobuf", "DXF": "RegisterOGRDXF",
    "OpenFileGDB": "RegisterOGROpenFileGDB",
}  # fmt: skip
OPEN_OPTIONS = {"GML": ["DOWNLOAD_SCHEMA=NO", "EXPOSE_FID=NO"]}
CONFIGURATION = {
    "GDAL_DRIVER_PATH": "disable", "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "GDAL_PAM_ENABLED": "NO", "GDAL_NUM_THREADS": "1",
    "GDAL_CACHEMAX": "48", "GDAL_VRT_ENABLE_PYTHON": "NO", "GDAL_HTTP_MAX_RETRY": "0", "CPL_VSIL_CURL_ALLOWED_EXTENSIONS": ".none",
    "PROJ_NETWORK": "OFF", "GTIFF_REPORT_COMPD_CS": "YES", "GML_SKIP_RESOLVE_ELEMS": "ALL",
    "GML_SAVE_RESOLVED_TO": "NONE", "DXF_INLINE_BLOCKS": "FALSE", "DXF_MAX_BSPLINE_CONTROL_POINTS": "2000",
    "OGR_GML_NESTING_LEVEL": "32",
}  # fmt: skip
WARNING, FAILURE = 2, 3  # CPLErr
_RASTER, _VECTOR, _VERBOSE = 0x02, 0x04, 0x40  # GDAL_OF_*
_MAX_MESSAGES = 20
_HANDLER = CFUNCTYPE(None, c_int, c_int, c_char_p)
_P, _S, _I, _D, _L = c_void_p, c_char_p, c_int, c_double, c_int64
_SIGNATURES: dict[str, tuple[Any, list[Any]]] = {
    "CPLSetConfigOption": (None, [_S, _S]), "CPLPushErrorHandler": (None, [_HANDLER]), "VSIFree": (None, [_P]),
    "GDALGetDriverCount": (_I, []), "GDALOpenEx": (_P, [_S, c_uint, POINTER(_S), POINTER(_S), POINTER(_S)]), "GDALClose": (None, [_P]),
    "GDALGetMetadataItem": (_S, [_P, _S, _S]), "GDALGetSpatialRef": (_P, [_P]), "GDALGetGeoTransform": (_I, [_P, POINTER(_D)]),
    "GDALGetGCPCount": (_I, [_P]),
    "GDALGetRasterXSize": (_I, [_P]), "GDALGetRasterYSize": (_I, [_P]), "GDALGetRasterCount": (_I, [_P]),
    "GDALGetRasterBand": (_P, [_P, _I]), "GDALGetRasterDataType": (_I, [_P]), "GDALGetBlockSize": (None, [_P, POINTER(_I), POINTER(_I)]),
    "GDALGetRasterNoDataValue": (_D, [_P, POINTER(_I)]), "GDALGetRasterScale": (_D, [_P, POINTER(_I)]),
    "GDALGetRasterOffset": (_D, [_P, POINTER(_I)]), "GDALGetRasterUnitType": (_S, [_P]), "GDALGetMaskFlags": (_I, [_P]),
    "GDALGetDataCoverageStatus": (_I, [_P, _I, _I, _I, _I, _I, POINTER(_D)]),
    "GDALRasterIO": (_I, [_P, _I, _I, _I, _I, _I, _P, _I, _I, _I, _I, _I]),
    "GDALDatasetGetLayerCount": (_I, [_P]), "GDALDatasetGetLayer": (_P, [_P, _I]),
    "OGR_L_GetName": (_S, [_P]), "OGR_L_GetGeomType": (_I, [_P]), "OGR_L_GetSpatialRef": (_P, [_P]), "OGR_L_GetLayerDefn": (_P, [_P]),
    "OGR_L_GetNextFeature": (_P, [_P]), "OGR_F_Destroy": (None, [_P]), "OGR_F_GetGeometryRef": (_P, [_P]),
    "OGR_F_IsFieldSetAndNotNull": (_I, [_P, _I]), "OGR_F_GetFieldAsInteger64": (_L, [_P, _I]), "OGR_F_GetFieldAsDouble": (_D, [_P, _I]),
    "OGR_F_GetFieldAsString": (_S, [_P, _I]),
    "OGR_FD_GetFieldCount": (_I, [_P]), "OGR_FD_GetFieldDefn": (_P, [_P, _I]),
    "OGR_Fld_GetNameRef": (_S, [_P]), "OGR_Fld_GetType": (_I, [_P]), "OGR_Fld_GetSubType": (_I, [_P]),
    "OGR_G_GetSpatialReference": (_P, [_P]), "OGR_G_WkbSizeEx": (c_size_t, [_P]), "OGR_G_ExportToIsoWkb": (_I, [_P, _I, _P]),
    "OGR_G_HasCurveGeometry": (_I, [_P, _I]), "OGR_G_GetLinearGeometry": (_P, [_P, _D, _P]), "OGR_G_DestroyGeometry": (None, [_P]),
    "OSRExportToWktEx": (_I, [_P, POINTER(_P), POINTER(_S)]), "OSRIsSame": (_I, [_P, _P]),
}  # fmt: skip


class Unreadable(Exception):
    """Raised for a file that GDAL does not read, with its words."""


class Gdal:
    """libgdal with one driver. library: its name for the loader, such as libgdal.so.32."""

    def __init__(self, library: str, driver: str) -> None:
        self._driver = driver
        self._library = ctypes.CDLL(library)
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(self._library, name)
            function.restype, function.argtypes = result, arguments
        self.messages: list[tuple[int, str]] = []
        self._handler = _HANDLER(self._keep)
        self.CPLPushErrorHandler(self._handler)
        for key, value in CONFIGURATION.items():
            self.CPLSetConfigOption(key.encode(), value.encode())
        getattr(self._library, REGISTER[driver])()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._library, name)

    def open(self, path: str) -> Any:
        """Return the data set. Raises Unreadable."""
        flags = (_RASTER if self._driver == "GTiff" else _VECTOR) | _VERBOSE
        options = OPEN_OPTIONS.get(self._driver, [])
        data_set = self.GDALOpenEx(path.encode(), flags, _strings([self._driver]), _strings(options), None)
        if not data_set:
            failure = self.failure()
            raise Unreadable(failure if failure and "not recognized" not in failure else f"it is no {self._driver}")
        return data_set

    def failure(self, least: int = FAILURE) -> str:
        """Return the first message of this class or worse since the start; empty if there is none."""
        return next((text for kind, text in self.messages if kind >= least), "")

    def wkt(self, system: Any) -> str | None:
        """Return a reference system as WKT 2; None if there is none."""
        if not system:
            return None
        text = c_void_p()
        self.OSRExportToWktEx(system, byref(text), _strings(["FORMAT=WKT2_2019", "MULTILINE=NO"]))
        found = ctypes.string_at(text.value).decode("utf-8", "replace") if text.value else ""
        self.VSIFree(text)
        return found or None

    def number(self, function: str, band: Any) -> float | None:
        """Return a number of a band that may be absent."""
        is_there = c_int()
        value = getattr(self, function)(band, byref(is_there))
        return float(value) if is_there.value else None

    def _keep(self, kind: int, _: int, message: bytes | None) -> None:
        if len(self.messages) < _MAX_MESSAGES:
            self.messages.append((kind, (message or b"").decode("utf-8", "replace")))


def _strings(values: list[str]) -> Any:
    return (c_char_p * (len(values) + 1))(*(value.encode() for value in values), None)
