"""What became of uploads: read, shown, placed, handed out as files that harm nobody, and deleted."""

from datetime import UTC, datetime
from pathlib import Path

import pytest
from django.test import Client

from results.models import Medium, MediumKind, MediumState, Placement
from results.services.reading import read_medium, read_waiting
from tests.accounts.users import a_user, client_of
from tests.results.photos import dji_photo, exif_of, file_of, picture, taken
from tests.results.sending import upload, upload_and_read
from workspace.models import AuditEntry, Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def client() -> Client:
    return client_of(a_user())


def test_a_photo_is_read_and_shown(client: Client) -> None:
    medium = upload_and_read(client, dji_photo(10.004, 56.0, size=(2_000, 1_500)))
    found = client.get(f"/api/v1/media/{medium.pk}").json()
    assert (found["state"], found["kind"], found["width_px"], found["height_px"]) == ("ready", "photo", 2_000, 1_500)
    assert found["position"] == {"type": "Point", "coordinates": [10.004, 56.0]}
    assert found["heights"][1] == {"value_m": 30.0, "reference": "take_off", "source": "drone-dji:RelativeAltitude"}
    assert (found["camera_pitch_deg"], found["attitude_source"], found["camera_model"]) == (-45.0, "drone-dji", "DJI FC6310")
    assert (found["taken_at"], found["taken_at_source"]) == ("2026-06-01T08:00:00Z", "camera")
    for edge in ("400", "1600"):
        answer = client.get(found["previews"][edge])
        assert (answer["Content-Type"], answer["Cache-Control"]) == ("image/webp", "private, max-age=31536000, immutable")
        assert b"".join(answer.streaming_content)[:4] == b"RIFF"
    assert client.get(f"/api/v1/media/{medium.pk}/previews/800").status_code == 404


def test_the_original_is_handed_out_unchanged_as_a_file_that_nothing_runs(client: Client) -> None:
    content = dji_photo()
    medium = upload_and_read(client, content, "tower.html")
    answer = client.get(f"/api/v1/media/{medium.pk}/file")
    assert b"".join(answer.streaming_content) == content
    assert answer["Content-Disposition"] == 'attachment; filename="tower.html.jpg"'
    assert (answer["Content-Type"], answer["X-Content-Type-Options"]) == ("image/jpeg", "nosniff")
    assert answer["Content-Security-Policy"] == "default-src 'none'; sandbox"
    assert answer["Cross-Origin-Resource-Policy"] == "same-origin"


def test_a_time_without_a_zone_is_in_that_of_the_organisation(client: Client) -> None:
    Organisation.objects.update(time_zone="America/New_York")
    medium = upload_and_read(client, file_of(picture(), exif=exif_of(camera=taken("2026:06:01 10:00:00"))))
    assert (medium.taken_at, medium.taken_at_source) == (datetime(2026, 6, 1, 14, tzinfo=UTC), "local")


@pytest.mark.parametrize("stated", ["0001:01:01 00:00:00", "9999:12:31 23:59:59", "1970:01:01 00:00:00", "2090:06:01 10:00:00"])
def test_a_clock_that_was_never_set_gives_no_time_and_holds_up_no_other(client: Client, stated: str) -> None:
    unset = upload(client, file_of(picture(), exif=exif_of(camera=taken(stated))))
    other = upload_and_read(client, dji_photo())
    unset.refresh_from_db()
    assert (unset.state, unset.taken_at, other.state) == (MediumState.READY, None, MediumState.READY)


def test_a_medium_that_cannot_be_stored_is_marked_and_holds_up_no_other(client: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(medium: Medium) -> None:
        if medium.pk == bad.pk:
            raise ValueError("out of range")
        read_medium(medium)

    bad = upload(client, dji_photo(10.01))
    monkeypatch.setattr("results.services.reading.read_medium", refuse)
    other = upload_and_read(client, dji_photo())
    bad.refresh_from_db()
    assert (bad.state, bad.fault, other.state) == (MediumState.NOT_SHOWN, "medium_decoder_failed", MediumState.READY)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (dji_photo(size=(800, 600))[:-3_000], "medium_truncated"),
        (b"\xff\xd8\xff" + b"\0" * 500, "medium_undecodable"),
        (b"\0\0\0\x18ftypheic" + b"\0" * 100, "medium_not_decoded"),
    ],
    ids=["truncated", "damaged", "HEIC"],
)
def test_what_cannot_be_shown_is_stored_and_says_why(client: Client, content: bytes, fault: str) -> None:
    medium = upload_and_read(client, content)
    found = client.get(f"/api/v1/media/{medium.pk}").json()
    assert (found["state"], found["fault_code"], found["previews"]) == ("not_shown", fault, {})
    assert found["fault"].endswith(".")
    assert b"".join(client.get(found["original"]).streaming_content) == content


def test_a_video_is_stored(client: Client) -> None:
    medium = upload_and_read(client, b"\0\0\0\x18ftypisom" + b"\0" * 100, "DJI_0002.MP4")
    assert (medium.kind, medium.media_type, medium.state) == (MediumKind.VIDEO, "video/mp4", MediumState.NOT_SHOWN)


def test_a_thermal_photo_is_told(client: Client) -> None:
    assert upload_and_read(client, dji_photo(ImageSource="InfraredCamera")).kind == MediumKind.THERMAL


def test_a_file_that_the_store_has_lost_is_told(client: Client, media_folder: Path) -> None:
    medium = upload(client, dji_photo())
    (media_folder / f"1/originals/{medium.sha256[:2]}/{medium.sha256}").unlink()
    read_waiting(budget_s=60.0)
    medium.refresh_from_db()
    assert medium.fault == "medium_missing"
    assert client.get(f"/api/v1/media/{medium.pk}/file").status_code == 404


def test_deleted_media_are_gone_with_their_files_and_in_the_history(
    client: Client, media_folder: Path, django_capture_on_commit_callbacks: object
) -> None:
    medium = upload_and_read(client, dji_photo())
    with django_capture_on_commit_callbacks(execute=True):  # type: ignore[operator]
        assert client.delete(f"/api/v1/media/{medium.pk}").status_code == 204
    assert [path for path in media_folder.rglob("*") if path.is_file()] == []
    assert AuditEntry.objects.get(subject_type="medium", action="delete").before["sha256"] == medium.sha256


def test_media_are_listed_by_when_they_were_taken_and_filtered(client: Client) -> None:
    late = upload_and_read(client, dji_photo(UTCAtExposure="2026-06-01T09:00:00"))
    early = upload_and_read(client, dji_photo(UTCAtExposure="2026-06-01T08:00:00"))
    first = client.get("/api/v1/media?limit=1").json()
    assert [one["id"] for one in first["results"]] == [str(early.pk)]
    assert [one["id"] for one in client.get(first["next"]).json()["results"]] == [str(late.pk)]
    client.patch(f"/api/v1/media/{late.pk}", {"review": "nothing"}, content_type="application/json")
    for query, expected in {
        "review=none": [early], "review=nothing": [late], "placement=unplaced": [early, late], "kind=video": [],
        "state=ready": [early, late],
    }.items():  # fmt: skip
        found = client.get(f"/api/v1/media?{query}").json()["results"]
        assert [one["id"] for one in found] == [str(medium.pk) for medium in expected], query
    assert client.get("/api/v1/media?placement=sure").status_code == 400


def test_a_look_is_stored_and_taken_back(client: Client) -> None:
    medium = upload_and_read(client, dji_photo())
    answer = client.patch(f"/api/v1/media/{medium.pk}", {"review": "nothing"}, content_type="application/json").json()
    assert answer["review"] == "nothing" and answer["reviewed_at"] is not None
    answer = client.patch(f"/api/v1/media/{medium.pk}", {"review": ""}, content_type="application/json").json()
    assert (answer["review"], answer["reviewed_at"]) == ("", None)
    assert client.patch(f"/api/v1/media/{medium.pk}", {"sha256": "0"}, content_type="application/json").status_code == 400
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.patch(f"/api/v1/media/{medium.pk}", {"review": "nothing"}, content_type="application/json").status_code == 403


def test_while_one_reads_another_does_not(client: Client) -> None:
    upload(client, dji_photo())
    assert not read_waiting(budget_s=0.0) or Medium.objects.get().placement == Placement.WAITING
    assert not read_waiting(budget_s=60.0)
    assert Medium.objects.get().state == MediumState.READY
