"""The page of the API: getting started, and the operations of the OpenAPI document by group. The page's script adds the details."""

import json
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from typing import Any

from workspace.api.api_document import stored
from workspace.pages import OpenPage


@dataclass(frozen=True)
class Operation:
    """One line of the page; `id` is its anchor."""

    id: str
    method: str
    path: str
    summary: str
    is_deprecated: bool


@dataclass(frozen=True)
class Group:
    """A tag of the document."""

    name: str
    title: str
    description: str
    operations: tuple[Operation, ...]


@dataclass(frozen=True)
class Heading:
    """A heading over several groups."""

    name: str
    groups: tuple[Group, ...]


class ApiPage(OpenPage):
    """Open to all, as the document is."""

    template_name = "api_docs.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        server = self.request.build_absolute_uri("/").rstrip("/")
        return super().get_context_data(**kwargs) | {
            "headings": headings(),
            "server": server,
            "websocket_server": server.replace("http", "ws", 1),
        }


@cache
def headings() -> tuple[Heading, ...]:
    """Return the operations of the document by heading and group."""
    return headings_of(json.loads(stored("json").plain))


def headings_of(document: dict[str, Any]) -> tuple[Heading, ...]:
    operations: dict[str, list[Operation]] = defaultdict(list)
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            row = Operation(operation["operationId"], method.upper(), path, operation["summary"], operation.get("deprecated", False))
            operations[operation["tags"][0]].append(row)
    groups = {
        tag["name"]: Group(tag["name"], tag["x-displayName"], tag["description"], tuple(operations[tag["name"]]))
        for tag in document["tags"]
    }
    return tuple(Heading(each["name"], tuple(groups[name] for name in each["tags"])) for each in document["x-tagGroups"])
