"""Requests made at random from the OpenAPI document: mostly what it allows, now and then not. The same seed, the same requests."""

import json
import math
import random
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any
from urllib.parse import quote, urlencode
from uuid import UUID

MAX_DEPTH = 6
BROKEN_SHARE = 0.15  # of values, by something that is not described
LEFT_OUT_SHARE = 0.5  # of what may be left out
ODD: tuple[Any, ...] = (
    None, True, "", "\x00", "🛩" * 40, "a" * 5_000, "'; DROP TABLE x; --", "../../etc/passwd", 0, -1, 2**31, 2**63, 2**70, -0.0, 1e308,
    [], {}, [[]], {"a": {"b": None}}, "2026-02-30T25:61:61Z", "9999-12-31T23:59:59+23:59", "\ud800", "NaN", "Infinity", math.pi,
)  # fmt: skip


@dataclass(frozen=True)
class Request:
    method: str
    template: str
    path: str
    headers: dict[str, str]
    body: str | bytes | None
    media_type: str
    described: Mapping[int, frozenset[str]]  # the headers of each status


class Maker:
    """`known` gives for the name of a path's parameter an id that there is."""

    def __init__(self, document: Mapping[str, Any], seed: int, known: Callable[[str], Any | None]) -> None:
        self._document, self._known, self._chance = document, known, random.Random(seed)
        self._operations = [
            (method.upper(), path, operation)
            for path, operations in document["paths"].items()
            for method, operation in operations.items()
            if method in {"get", "post", "put", "patch", "delete"}
        ]

    def requests(self, number: int) -> Iterator[Request]:
        """Every operation in turn, so that each has its share."""
        for turn in range(number):
            yield self._request(*self._operations[turn % len(self._operations)])

    @property
    def operations(self) -> int:
        return len(self._operations)

    def _request(self, method: str, template: str, operation: Mapping[str, Any]) -> Request:
        path, query, headers = template, {}, {}
        for parameter in operation.get("parameters", []):
            name, where = parameter["name"], parameter["in"]
            if where == "path":
                path = path.replace(f"{{{name}}}", quote(str(self._id(name, parameter["schema"])).encode("utf-8", "replace"), safe=""))
            elif parameter.get("required") or self._chance.random() > LEFT_OUT_SHARE:
                value = self._known(name) if where == "query" and self._chance.random() < 0.3 else None
                reported = str(self._value(parameter["schema"]) if value is None else value)
                if where == "query":
                    query[name] = reported.encode("utf-8", "replace")
                else:
                    headers[name] = self._chance.choice(['"1"', '"2"', "*", "W/1", reported.encode("ascii", "replace").decode()[:50]])
        content = operation.get("requestBody", {}).get("content", {})
        media_type, body = "application/json", None
        if content:
            media_type = self._chance.choice(sorted(content))
            body = self._body(content[media_type].get("schema", {}), media_type)
        described = {int(status): frozenset(response.get("headers", {})) for status, response in operation["responses"].items()}
        address = path + (f"?{urlencode(query)}" if query else "")
        return Request(
            method, template, address, {k: v.replace("\n", "").replace("\x00", "") for k, v in headers.items()}, body, media_type, described
        )

    def _body(self, schema: Mapping[str, Any], media_type: str) -> str | bytes:
        if media_type != "application/json":
            return self._chance.randbytes(self._chance.choice([0, 1, 1_000]))
        if self._chance.random() < 0.02:
            return self._chance.choice(["", "{", "[" * 2_000, '{"a": NaN}', '{"a": 1e999}', "null", "\ufeff{}"])
        return json.dumps(self._value(schema))

    def _id(self, name: str, schema: Mapping[str, Any]) -> Any:
        known = self._known(name)
        if known is not None and self._chance.random() < 0.7:
            return known
        return self._value(schema) if self._chance.random() < 0.7 else self._chance.choice(["0", "-1", 2**31, 2**63, "%00", "a b", "é"])

    # --- values by their schema ------------------------------------------------------------------------------------------------------

    def _value(self, schema: Mapping[str, Any], depth: int = 0) -> Any:
        chance = self._chance
        if chance.random() < BROKEN_SHARE / (1 + depth):
            return chance.choice(ODD)
        if "$ref" in schema:
            return self._value(self._document["components"]["schemas"][schema["$ref"].rpartition("/")[2]], depth)
        for name in ("oneOf", "anyOf"):
            if name in schema:
                return self._value(chance.choice(schema[name]), depth)
        if "allOf" in schema:
            return self._value(schema["allOf"][0], depth)
        if "enum" in schema:
            return chance.choice(schema["enum"])
        kind = schema.get("type", "object")
        return self._of_kind(chance.choice(kind) if isinstance(kind, list) else kind, schema, depth)

    def _of_kind(self, kind: str, schema: Mapping[str, Any], depth: int) -> Any:
        chance = self._chance
        match kind:
            case "object":
                return self._object(schema, depth)
            case "array":
                most = min(schema.get("maxItems", 4), 4) if depth < MAX_DEPTH else 0
                count = chance.randint(min(schema.get("minItems", 0), 4), max(most, schema.get("minItems", 0)))
                return [self._value(schema.get("items", {}), depth + 1) for _ in range(min(count, 6))]
            case "integer":
                return chance.choice(
                    [chance.randint(0, 10), schema.get("minimum", 0), schema.get("maximum", 100), chance.randint(-5, 10**6)]
                )
            case "number":
                least, most_ = schema.get("minimum", -200.0), schema.get("maximum", 200.0)
                return chance.choice([chance.uniform(least, most_), least, most_, 10.0, 56.0])
            case "boolean":
                return chance.random() < 0.5
            case "null":
                return None
        return self._text(schema)

    def _object(self, schema: Mapping[str, Any], depth: int) -> dict[str, Any]:
        required = set(schema.get("required", []))
        made = {}
        for name, inner in schema.get("properties", {}).items():
            if name in required or (depth < MAX_DEPTH and self._chance.random() > LEFT_OUT_SHARE):
                known = self._known(name) if self._chance.random() < 0.3 else None
                made[name] = self._value(inner, depth + 1) if known is None else known
        if self._chance.random() < BROKEN_SHARE / 3:
            made["not_described"] = self._chance.choice(ODD)
        if required and self._chance.random() < BROKEN_SHARE / 3:
            made.pop(self._chance.choice(sorted(required)), None)
        return made

    def _text(self, schema: Mapping[str, Any]) -> str:
        chance = self._chance
        match schema.get("format"):
            case "date-time":
                return (datetime(2026, 11, 1, tzinfo=UTC) + timedelta(hours=chance.randint(-10_000, 10_000))).isoformat()
            case "date":
                return f"2026-{chance.randint(1, 12):02}-{chance.randint(1, 28):02}"
            case "uuid":
                return str(UUID(int=chance.getrandbits(128), version=4))
        return chance.choice(["", "Tern", "10,56", "9.9,55.9,10.1,56.1", "Ö" * 20, "x" * min(schema.get("maxLength", 100), 300)])
