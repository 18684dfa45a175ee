"""All data of a mission in one ZIP file for other programs."""

import json
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

from django.conf import settings
from django.core.serializers.json import DjangoJSONEncoder

from missions.models import Mission
from missions.selectors.commands import commands_of_mission
from telemetry.exports.captures import captures_csv, captures_geojson
from telemetry.exports.csv_file import csv_of_records
from telemetry.exports.geojson_file import geojson_of_records
from telemetry.exports.thinning import rounded
from telemetry.models import Alert, FlightLog, PositionEstimate
from telemetry.selectors.captures import all_captures
from telemetry.selectors.columns import latitude, longitude
from telemetry.selectors.log import LogFilter, logged, records_that_match
from telemetry.selectors.mission_record import approval_on_record, mission_record
from workspace.models import Organisation

IN_MEMORY_BYTES = 4 << 20
CONTENTS = """What this file holds, of one mission. What was not recorded has no file.

record.json       what was planned and flown, by leg and target, and what UAVs found
approval.json     the plan as it was approved: routes, zones, conditions; content_sha256 names it
telemetry.csv     every record of every UAV, units in the names of the columns, rounded to the resolution of the sensors
telemetry.geojson the same as GeoJSON
photos.csv        every photo that was reported: where, when, and where the camera looked, with bounds
photos.geojson    the same as GeoJSON
estimates.jsonl   where UAVs were estimated to be between reports, one JSON object a line
alerts.json       with their notes
commands.json     what UAVs were told, by whom, and what became of it
flight-logs/      MAVLink as it was received and sent (tlog)

Times are UTC. Heights name their reference. Map data of targets: (c) OpenStreetMap contributors, ODbL.
"""
_ESTIMATED = (
    "uav_id", "estimated_for", "made_at", "report_at", "altitude_amsl_m", "altitude_relative_m", "speed_mps", "heading_deg",
    "bound_along_m", "bound_across_m", "bound_bearing_deg", "bound_height_m", "bound_speed_mps", "waypoint_sequence", "is_lost",
    "replaced_at",
)  # fmt: skip


def record_file(organisation: Organisation, mission: Mission) -> IO[bytes]:
    """Return the file, positioned at its beginning; deleted when closed."""
    whole = tempfile.SpooledTemporaryFile(max_size=IN_MEMORY_BYTES)  # noqa: SIM115 - closed by the sender
    records = records_that_match(organisation, LogFilter(mission_id=mission.pk))
    approval = approval_on_record(mission)
    with zipfile.ZipFile(whole, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("README.txt", CONTENTS)
        packed.writestr("record.json", _json(mission_record(mission)))
        if approval is not None:
            packed.writestr("approval.json", _json({"content_sha256": approval.content_sha256, "document": approval.document}))
        if records.exists():
            _write(packed, "telemetry.csv", csv_of_records(map(rounded, logged(records, "measured_at", "pk"))))
            _write(packed, "telemetry.geojson", geojson_of_records(map(rounded, logged(records, "measured_at", "pk"))))
        if mission.captures.exists():
            _write(packed, "photos.csv", captures_csv(all_captures(mission)))
            _write(packed, "photos.geojson", captures_geojson(all_captures(mission)))
        if PositionEstimate.objects.filter(mission=mission).exists():
            _write(packed, "estimates.jsonl", _estimates(mission))
        packed.writestr("alerts.json", _json(_alerts(mission)))
        packed.writestr("commands.json", _json(_commands(mission)))
        for log in FlightLog.objects.filter(mission=mission).order_by("started_at"):
            path = Path(settings.FLIGHT_LOG_DIR) / log.path
            if path.is_file():
                packed.write(path, f"flight-logs/{log.uav_id}-{path.name}")
    whole.seek(0)
    return whole


def _json(value: Any) -> str:
    return json.dumps(value, cls=DjangoJSONEncoder, ensure_ascii=False, indent=1)


def _write(packed: zipfile.ZipFile, name: str, pieces: Iterable[str]) -> None:
    with packed.open(name, "w", force_zip64=True) as entry:
        for piece in pieces:
            entry.write(piece.encode())


def _estimates(mission: Mission) -> Iterator[str]:
    rows = (
        PositionEstimate.objects.filter(mission=mission)
        .order_by("estimated_for", "uav_id")
        .values_list(*_ESTIMATED, longitude(), latitude())
    )
    for *reported, lon, lat in rows.iterator(chunk_size=5_000):
        values = dict(zip(_ESTIMATED, reported, strict=True)) | {"longitude_deg": lon, "latitude_deg": lat}
        yield json.dumps(values, cls=DjangoJSONEncoder) + "\n"


def _alerts(mission: Mission) -> list[dict[str, Any]]:
    return [
        {
            "uav": alert.uav.name if alert.uav else None,
            **{name: getattr(alert, name) for name in ("code", "subject", "level", "message", "values", "details")},
            **{name: getattr(alert, name) for name in ("opened_at", "closed_at", "close_reason", "acknowledged_at")},
            "acknowledged_by": alert.acknowledged_by.username if alert.acknowledged_by else None,
            "notes": [
                {"author": note.author.username if note.author else None, "text": note.text, "written_at": note.written_at}
                for note in alert.notes.all()
            ],
        }
        for alert in Alert.objects.filter(mission=mission)
        .select_related("uav", "acknowledged_by")
        .prefetch_related("notes__author")
        .order_by("opened_at", "pk")
    ]


def _commands(mission: Mission) -> list[dict[str, Any]]:
    return [
        {
            "uav": command.uav.name,
            "by": command.created_by.username if command.created_by else None,
            **{name: getattr(command, name) for name in ("id", "sequence", "kind", "parameters", "state", "why", "attempts")},
            **{name: getattr(command, name) for name in ("created_at", "sent_at", "acknowledged_at", "finished_at")},
            **{name: getattr(command, name) for name in ("outcome_code", "outcome")},
        }
        for command in commands_of_mission(mission).order_by("created_at", "sequence")
    ]
