"""Snapshot of an organisation's rows: the objects shown now, and the texts of those changed since the previous snapshot."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from uuid import UUID

from telemetry.live.objects import SAME_IN_ALL, language_of, texts_of
from telemetry.selectors.live import Key, ShownObject, shown_live


@dataclass(frozen=True, slots=True)
class Text:
    version: int
    text: str


@dataclass(frozen=True)
class LiveSnapshot:
    """A snapshot. `texts` are by language; objects without text are under SAME_IN_ALL."""

    shown: Mapping[Key, ShownObject] = field(default_factory=dict)
    texts: Mapping[str, Mapping[Key, Text]] = field(default_factory=dict)

    def text(self, key: Key, language: str) -> str | None:
        found = self.texts.get(language_of(key[0], language), {}).get(key)
        return None if found is None else found.text

    def is_shown(self, key: Key, mission: UUID | None) -> bool:
        entry = self.shown.get(key)
        return entry is not None and entry.is_for(mission)


def read_snapshot(organisation_id: int, missions: Collection[UUID], languages: Collection[str], before: LiveSnapshot) -> LiveSnapshot:
    """Return the snapshot. An object that changes during the read may be newer than its version; the next poll then sends it again."""
    shown = shown_live(organisation_id, missions)
    texts = {language: _texts(shown, language, before.texts.get(language, {})) for language in {SAME_IN_ALL, *languages}}
    return LiveSnapshot(shown, texts)


def page_snapshot(organisation_id: int, mission: UUID | None, language: str, *, known: str = "") -> LiveSnapshot:
    """Return the snapshot of one page; without texts if its ETag equals `known`."""
    shown = shown_live(organisation_id, [] if mission is None else [mission])
    snapshot = LiveSnapshot({key: entry for key, entry in shown.items() if entry.is_for(mission)})
    if known and known == etag_of(snapshot, language):
        return snapshot
    return LiveSnapshot(snapshot.shown, {each: _texts(snapshot.shown, each, {}) for each in {SAME_IN_ALL, language}})


def etag_of(snapshot: LiveSnapshot, language: str) -> str:
    versions = sorted((*key, entry.version) for key, entry in snapshot.shown.items())
    return f'"{sha256(repr((language, versions)).encode()).hexdigest()[:32]}"'


def changed_between(before: LiveSnapshot, now: LiveSnapshot, mission: UUID | None) -> set[Key]:
    """Return the keys to send to pages of the mission, or of the organisation: changed, added or removed."""
    changed = {
        key
        for key, entry in now.shown.items()
        if entry != before.shown.get(key) and (entry.is_for(mission) or before.is_shown(key, mission))
    }
    return changed | {key for key in before.shown.keys() - now.shown.keys() if before.is_shown(key, mission)}


def _texts(shown: Mapping[Key, ShownObject], language: str, before: Mapping[Key, Text]) -> dict[Key, Text]:
    own = {key: entry for key, entry in shown.items() if language_of(key[0], language) == language}
    stale = [key for key, entry in own.items() if key not in before or before[key].version != entry.version]
    fresh = texts_of(stale, language) if stale else {}
    kept = {key: text for key, text in before.items() if key in own}
    return kept | {key: Text(own[key].version, text) for key, text in fresh.items() if key in own}
