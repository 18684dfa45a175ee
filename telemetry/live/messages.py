"""Messages to live pages, composed of objects that are already JSON text."""

from collections.abc import Iterable
from datetime import UTC, datetime
from uuid import UUID

from telemetry.live.snapshot import LiveSnapshot
from telemetry.selectors.live import KINDS, Key


def server_time() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def message(kind: str, sequence: int, body: str = "") -> str:
    head = f'"type":"{kind}","sequence":{sequence},"server_time":"{server_time()}"'
    return f"{{{head},{body}}}" if body else f"{{{head}}}"


def everything(read_snapshot: LiveSnapshot, mission: UUID | None, language: str) -> str:
    """Return the body of a snapshot message."""
    return f'"live":{live_text(read_snapshot, mission, language)}'


def live_text(read_snapshot: LiveSnapshot, mission: UUID | None, language: str) -> str:
    """Return `{"uavs": […], …}`, as in GET /api/v1/live."""
    texts: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for key, entry in read_snapshot.shown.items():
        text = read_snapshot.text(key, language)
        if text is not None and entry.is_for(mission):
            texts[key[0]].append(text)
    return "{" + ",".join(f'"{kind}":[{",".join(texts[kind])}]' for kind in KINDS) + "}"


def changes(read_snapshot: LiveSnapshot, mission: UUID | None, language: str, keys: Iterable[Key]) -> str:
    """Return the body of a changes message: shown objects as a whole, and the ids of removed ones."""
    there: dict[str, list[str]] = {kind: [] for kind in KINDS}
    removed: dict[str, list[str]] = {kind: [] for kind in KINDS}
    for key in sorted(keys):
        kind, name = key
        text = read_snapshot.text(key, language) if read_snapshot.is_shown(key, mission) else None
        if text is not None:
            there[kind].append(text)
        else:
            removed[kind].append(name if name.isdigit() else f'"{name}"')
    parts = [f'"{kind}":[{",".join(there[kind])}]' for kind in KINDS]
    ended = ",".join(f'"{kind}":[{",".join(removed[kind])}]' for kind in KINDS)
    return ",".join(parts) + f',"removed":{{{ended}}}'
