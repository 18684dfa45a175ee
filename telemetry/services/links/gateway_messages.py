"""Stores what a gateway received in one transaction: records, link states, texts and sightings.

Signature timestamps are stored with the records of their frames: a frame may be repeated if its record was lost with a gateway, but not if
it was stored.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from django.db import transaction

from missions.models import Uav
from telemetry.models import VehicleText
from telemetry.services.captures import NewCapture, store_captures
from telemetry.services.ingest import NewRecord, StoredCount, store_records
from telemetry.services.links.links import LinkState, save_links
from telemetry.services.links.sightings import Sighting, note_unknown_vehicles


@dataclass(frozen=True)
class ReceivedText:
    uav_id: int
    severity: int
    text: str
    received_at: datetime


@dataclass(frozen=True)
class ReceivedBatch:
    records: Sequence[NewRecord] = ()
    links: Sequence[LinkState] = ()
    texts: Sequence[ReceivedText] = ()
    sightings: Sequence[Sighting] = ()
    captures: Sequence[NewCapture] = ()

    def __bool__(self) -> bool:
        return bool(self.records or self.links or self.texts or self.sightings or self.captures)


@transaction.atomic
def store_received(*, received: ReceivedBatch, holder: str) -> StoredCount:
    stored = store_records(received.records) if received.records else StoredCount()
    if received.captures:
        store_captures(received.captures)
    save_links(states=received.links, holder=holder)
    if received.texts:
        there = set(Uav.objects.filter(pk__in={text.uav_id for text in received.texts}).values_list("pk", flat=True))
        VehicleText.objects.bulk_create(
            VehicleText(uav_id=text.uav_id, severity=text.severity, text=text.text, received_at=text.received_at)
            for text in received.texts
            if text.uav_id in there
        )
    note_unknown_vehicles(sightings=received.sightings)
    return stored
