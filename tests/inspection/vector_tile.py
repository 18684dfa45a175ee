"""Reads a Mapbox vector tile (specification 2.1): enough of protocol buffers to see what is in it."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Feature:
    id: int | None = None
    type: int = 0  # 1 point, 2 line, 3 polygon
    properties: dict[str, Any] = field(default_factory=dict)
    geometry: list[int] = field(default_factory=list)  # commands and parameters

    @property
    def first_position(self) -> tuple[int, int]:
        x, y = self.geometry[1:3]
        return (x >> 1) ^ -(x & 1), (y >> 1) ^ -(y & 1)

    @property
    def vertex_count(self) -> int:
        count, place = 0, 0
        while place < len(self.geometry):
            command, times = self.geometry[place] & 7, self.geometry[place] >> 3
            count += times if command != 7 else 0
            place += 1 + (2 * times if command != 7 else 0)
        return count


def read_tile(data: bytes) -> dict[str, list[Feature]]:
    layers = {}
    for number, layer in _fields(data):
        assert number == 3
        parts = list(_fields(layer))
        keys = [value.decode() for number, value in parts if number == 3]
        values = [_value(value) for number, value in parts if number == 4]
        name = next(value.decode() for number, value in parts if number == 1)
        layers[name] = [_feature(value, keys, values) for number, value in parts if number == 2]
    return layers


def _feature(data: bytes, keys: list[str], values: list[Any]) -> Feature:
    feature = Feature()
    for number, value in _fields(data):
        if number == 1:
            feature.id = value
        elif number == 2:
            tags = list(_varints(value))
            feature.properties = {keys[key]: values[place] for key, place in zip(tags[::2], tags[1::2], strict=True)}
        elif number == 3:
            feature.type = value
        elif number == 4:
            feature.geometry = list(_varints(value))
    return feature


def _value(data: bytes) -> Any:
    [(number, value)] = _fields(data)
    if number == 1:
        return value.decode()
    if number == 6:
        return (value >> 1) ^ -(value & 1)
    return bool(value) if number == 7 else value


def _fields(data: bytes) -> Iterator[tuple[int, Any]]:
    place = 0
    while place < len(data):
        key, place = _varint(data, place)
        kind = key & 7
        if kind == 0:
            value, place = _varint(data, place)
            yield key >> 3, value
        elif kind == 2:
            length, place = _varint(data, place)
            yield key >> 3, data[place : place + length]
            place += length
        else:
            size, code = {1: (8, "<d"), 5: (4, "<f")}[kind]
            yield key >> 3, struct.unpack(code, data[place : place + size])[0]
            place += size


def _varints(data: bytes) -> Iterator[int]:
    place = 0
    while place < len(data):
        value, place = _varint(data, place)
        yield value


def _varint(data: bytes, place: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        byte = data[place]
        value |= (byte & 127) << shift
        place, shift = place + 1, shift + 7
        if byte < 128:
            return value, place
