"""Writes small OSM XML files for tests."""

from pathlib import Path
from xml.sax.saxutils import quoteattr

Tags = dict[str, str]
Nodes = dict[int, tuple[float, float, Tags]]
Ways = dict[int, tuple[list[int], Tags]]
Relations = dict[int, tuple[list[tuple[str, int, str]], Tags]]


def osm_xml(
    nodes: Nodes, ways: Ways | None = None, relations: Relations | None = None, *, bounds: str = "", timestamp: str | None = None
) -> str:
    """nodes: id → (lon, lat, tags); ways: id → (node ids, tags); relations: id → (members (type, id, role), tags)."""
    head = f" timestamp={quoteattr(timestamp)}" if timestamp else ""
    lines = [f"<?xml version='1.0' encoding='UTF-8'?><osm version=\"0.6\"{head}>{bounds}"]
    for osm_id, (lon, lat, tags) in nodes.items():
        lines.append(f'<node id="{osm_id}" lon="{lon}" lat="{lat}">{_tags(tags)}</node>')
    for osm_id, (refs, tags) in (ways or {}).items():
        lines.append(f'<way id="{osm_id}">{"".join(f"<nd ref={quoteattr(str(ref))}/>" for ref in refs)}{_tags(tags)}</way>')
    for osm_id, (members, tags) in (relations or {}).items():
        inside = "".join(f'<member type="{kind}" ref="{ref}" role="{role}"/>' for kind, ref, role in members)
        lines.append(f'<relation id="{osm_id}">{inside}{_tags(tags)}</relation>')
    return "".join([*lines, "</osm>"])


def write_osm(path: Path, nodes: Nodes, ways: Ways | None = None, relations: Relations | None = None, *, bounds: str = "") -> Path:
    path.write_text(osm_xml(nodes, ways, relations, bounds=bounds))
    return path


def _tags(tags: Tags) -> str:
    return "".join(f"<tag k={quoteattr(key)} v={quoteattr(value)}/>" for key, value in tags.items())


TOWER = {"power": "tower"}


def small_line(without: set[int] = frozenset()) -> tuple[Nodes, Ways]:
    """Four towers 300 m apart and the line over them: 1 -- 2 -- 3 -- 4; `without` leaves towers out of both."""
    nodes: Nodes = {number: (9.0 + 0.004 * number, 47.0, TOWER) for number in range(1, 5) if number not in without}
    return nodes, {10: (list(nodes), {"power": "line", "voltage": "110000"})}
