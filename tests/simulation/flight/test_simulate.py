"""`manage.py simulate`: its file in, its file out, and what it answers to files that make no sense."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from django.core.management import CommandError, call_command

from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import Weather
from simulation.flight.route_flight import MAX_WAYPOINTS, InvalidRoute, RouteFile, cross_track_m, fly_route, items_of, read_route
from tests.simulation.flight.lists import HOME, off_m, place, wind

ROOT = Path(__file__).resolve().parents[3]


def route(*metres: tuple[float, float], height_m: float = 12.0, speed_mps: float = 5.0) -> dict[str, Any]:
    waypoints = [{"position": list(place(*point)), "altitude_relative_m": height_m} for point in metres]
    return {"waypoints": waypoints, "speed_mps": speed_mps}


@pytest.mark.long
def test_route_is_flown_from_a_shell_without_database_and_redis(tmp_path: Path) -> None:
    (tmp_path / "route.json").write_text(json.dumps(route((0, 0), (30, 0), (30, 20))))
    command = ["manage.py", "simulate", tmp_path / "route.json", "--wind", "6,350", "--gusts", "1.5", "--seed", "3"]
    environment = {**os.environ, "DATABASE_URL": "postgres://nobody@/none", "REDIS_URL": "unix:///none"}
    out = tmp_path / "out.json"
    done = subprocess.run(  # noqa: S603
        [sys.executable, *command, "--json", out], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("pass: ")
    reported = json.loads(out.read_text())
    assert set(reported) == {"track", "cross_track_rms_m", "cross_track_max_m", "energy_wh", "duration_s", "assessment"}
    assert reported["assessment"] == {"result": "pass", "reasons": []}
    assert reported["track"][0][0] == 0.0
    assert all(len(line) == 4 for line in reported["track"])
    assert reported["track"][-1][0] == pytest.approx(reported["duration_s"], abs=0.2)
    assert off_m(HOME._replace(lon=reported["track"][-1][1], lat=reported["track"][-1][2]), place(30, 20)) < 1.0
    assert 0.0 < reported["cross_track_rms_m"] < reported["cross_track_max_m"] < 2.0
    assert 0.3 < reported["energy_wh"] < 3.0


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ([], "not an object"),
        ({"waypoints": [], "speed_mps": 5}, "at least one"),
        ({"waypoints": "here", "speed_mps": 5}, "at least one"),
        ({"waypoints": [1], "speed_mps": 5}, r"waypoints\[0\] is not an object"),
        ({"waypoints": [{"position": [9, 47]}], "speed_mps": 5}, "altitude_relative_m must be a number"),
        ({"waypoints": [{"position": [9, 47, 3], "altitude_relative_m": 9}], "speed_mps": 5}, "longitude, latitude"),
        ({"waypoints": [{"position": [47, 97], "altitude_relative_m": 9}], "speed_mps": 5}, "latitude, must be from -85 to 85"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": float("nan")}], "speed_mps": 5}, "not nan"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": -4}], "speed_mps": 5}, "not -4"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": 10**400}], "speed_mps": 5}, "not a number so large"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": True}], "speed_mps": 5}, "must be a number"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": 9}]}, "speed_mps must be a number"),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": 9}], "speed_mps": 0}, "speed_mps must be from"),
        (
            {"waypoints": [{"position": position, "altitude_relative_m": 9} for position in ([9, 47], [47, 9])], "speed_mps": 5},
            r"km from the one before.*\[longitude, latitude\]",
        ),
        (
            {
                "waypoints": [{"position": position, "altitude_relative_m": 9} for position in ([179.9999, 1], [-179.9999, 1])],
                "speed_mps": 5,
            },
            "180th meridian",
        ),
        ({"waypoints": [{"position": [9, 47], "altitude_relative_m": 9}] * (MAX_WAYPOINTS + 1), "speed_mps": 5}, "at most 9,000"),
    ],
)
def test_route_that_makes_no_sense_is_named(wrong: Any, words: str) -> None:
    with pytest.raises(InvalidRoute, match=words):
        read_route(wrong)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--wind", "8"], "--wind is"),
        (["--wind", "nan,0"], "speed_mps: must be"),
        (["--wind", "8,nan"], "from_deg: must be"),
        (["--wind", "-3,0"], "speed_mps: must be"),
        (["--wind", "300,0"], "speed_mps: must be"),
        (["--gusts", "nan"], "gusts_mps must be"),
        (["--battery", "120"], "--battery must be"),
    ],
)
def test_air_and_battery_that_make_no_sense_are_named(tmp_path: Path, options: list[str], words: str) -> None:
    (tmp_path / "route.json").write_text(json.dumps(route((0, 0), (20, 0))))
    with pytest.raises(CommandError, match=words):
        call_command("simulate", tmp_path / "route.json", *[f"{options[0]}={options[1]}"], "--json", tmp_path / "out.json")
    assert not (tmp_path / "out.json").exists()


@pytest.mark.parametrize("content", [b"", b"{", b"\xff\xfe", b"[" * 100_000, b'{"waypoints": [{"position": [1e999, 2]}], "speed_mps": 1}'])
def test_file_that_is_no_route_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "route.json").write_bytes(content)
    with pytest.raises(CommandError):
        call_command("simulate", tmp_path / "route.json", "--json", tmp_path / "out.json")
    with pytest.raises(CommandError):
        call_command("simulate", tmp_path / "none.json", "--json", tmp_path / "out.json")


def test_one_waypoint_is_a_hover_and_a_landing() -> None:
    reported = fly_route(read_route(route((0, 0))), AIRFRAMES["iris"], weather=Weather(), seed=1).as_json()
    assert reported["assessment"]["result"] == "pass"
    assert reported["cross_track_max_m"] < 0.2


def test_thousands_of_waypoints_are_flown_as_far_as_the_battery_goes() -> None:
    points = [(0.5 * number, 3.0 * (number % 2)) for number in range(4_000)]
    flight = fly_route(read_route(route(*points)), AIRFRAMES["iris"], weather=Weather(), seed=1, battery_percent=16.0)
    reported = flight.as_json()
    assert reported["assessment"]["result"] == "fail"
    assert any("Not reached: " in reason and "of 4000" in reason for reason in reported["assessment"]["reasons"])
    assert reported["cross_track_max_m"] < 2.0


def test_weak_battery_fails_with_its_reasons() -> None:
    reported = fly_route(read_route(route((0, 0), (150, 0))), AIRFRAMES["iris"], weather=Weather(), seed=1, battery_percent=17.0).as_json()
    reasons = " ".join(reported["assessment"]["reasons"])
    assert reported["assessment"]["result"] == "fail"
    assert "Battery low: 15 %" in reasons
    assert "Not reached: waypoint 2 of 2" in reasons
    assert "limit 20 %" in reasons


def test_empty_battery_does_not_take_off() -> None:
    reported = fly_route(read_route(route((0, 0), (50, 0))), AIRFRAMES["iris"], weather=Weather(), seed=1, battery_percent=3.0).as_json()
    assert reported["assessment"]["result"] == "fail"
    assert "did not take off" in reported["assessment"]["reasons"][0]
    assert reported["track"] == []


def test_wind_that_nobody_can_fly_fails_and_comes_to_an_end() -> None:
    flight = fly_route(read_route(route((0, 0), (60, 0))), AIRFRAMES["iris"], weather=wind(20.0), seed=1, battery_percent=16.0)
    reported = flight.as_json()
    assert reported["assessment"]["result"] == "fail"
    assert any("wind of 20.0 m/s" in reason for reason in reported["assessment"]["reasons"])
    json.dumps(reported, allow_nan=False)


def test_cross_track_is_that_of_a_place_beside_a_leg() -> None:
    """3 m beside the middle of a leg, 4 m past its end, and on the next leg."""
    waypoints = [HOME, place(100.0, 0.0), place(100.0, 100.0)]
    track = np.array([place(50.0, 3.0), place(104.0, 0.0), place(100.0, 40.0), place(-5.0, 0.0)])
    found = cross_track_m(track, np.array([1, 1, 2, 1]), waypoints)
    assert found == pytest.approx([3.0, 4.0, 0.0, 5.0], abs=0.01)


def test_file_is_flown_as_the_items_that_a_vehicle_would_be_sent() -> None:
    items = items_of(RouteFile((HOME, place(10.0, 0.0)), (12.0, 15.0), 4.0))
    assert [item.command for item in items] == [22, 178, 16, 16, 21]
    assert items[1].parameters[1] == 4.0
