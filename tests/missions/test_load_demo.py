"""manage.py load_demo: UAVs at their bases, an administrator only where nobody has an account."""

from io import StringIO
from pathlib import Path

import pytest
from django.contrib.gis.geos import Point
from django.core.management import CommandError, call_command

from missions.models import Base, Uav, UavType
from planning.views.catalogue import catalogue
from workspace.models import Role, User

pytestmark = pytest.mark.django_db

PASSWORD = "far from any real town"


def load_demo(*arguments: str) -> str:
    output = StringIO()
    call_command("load_demo", *arguments, stdout=output)
    return output.getvalue()


@pytest.fixture
def password_file(tmp_path: Path) -> Path:
    path = tmp_path / "password"
    path.write_text(f"{PASSWORD}\n")
    return path


def test_four_uavs_stand_at_two_bases() -> None:
    load_demo()
    assert Uav.objects.count() == 4
    assert Uav.objects.values("base_name", "location").distinct().count() == 2


def test_each_uav_has_a_complete_type_and_a_base() -> None:
    load_demo()
    assert (UavType.objects.count(), Base.objects.count()) == (2, 2)
    kestrel = Uav.objects.get(name="Kestrel 1")
    camera = catalogue()["sony-a7r-iv-55"].camera.name
    assert (kestrel.range_m, kestrel.speed_mps, kestrel.sensors) == (24_000.0, 12.0, ["RGB camera", "Thermal camera", camera])
    assert all(None not in (row.battery_wh, row.mass_kg, row.max_airspeed_mps, row.hover_power_w) for row in UavType.objects.all())
    assert kestrel.is_simulated and kestrel.is_demo
    assert kestrel.base is not None
    assert kestrel.location == kestrel.base.location


def test_loading_again_changes_nothing_not_even_a_uav_that_has_moved() -> None:
    load_demo()
    elsewhere = Point(26.5, 25.8, srid=4326)
    Uav.objects.filter(name="Kestrel 1").update(location=elsewhere)
    load_demo()
    assert Uav.objects.count() == 4
    assert Uav.objects.get(name="Kestrel 1").location == elsewhere


def test_the_administrator_signs_in_with_the_first_line_of_the_file(password_file: Path) -> None:
    load_demo("--user", "demo", "--password-file", str(password_file))
    user = User.objects.get()
    assert user.username == "demo"
    assert user.role == Role.ADMINISTRATOR
    assert user.check_password(PASSWORD)


def test_no_administrator_is_made_where_somebody_has_an_account(password_file: Path) -> None:
    User.objects.create_user(username="somebody", password=PASSWORD)
    load_demo("--user", "demo", "--password-file", str(password_file))
    assert not User.objects.filter(username="demo").exists()


def test_without_a_name_no_account_is_made() -> None:
    load_demo()
    assert not User.objects.exists()


def test_own_data_gets_an_administrator_without_the_demos_uavs(password_file: Path) -> None:
    load_demo("--no-uavs", "--user", "demo", "--password-file", str(password_file))
    assert User.objects.get().username == "demo"
    assert not Uav.objects.exists()


def test_a_name_without_a_password_file_is_refused() -> None:
    with pytest.raises(CommandError, match="go together"):
        load_demo("--user", "demo")


@pytest.mark.parametrize("content", ["", "\nsecond line\n"])
def test_an_empty_password_is_refused_and_nothing_is_made(tmp_path: Path, content: str) -> None:
    path = tmp_path / "password"
    path.write_text(content)
    with pytest.raises(CommandError, match="empty"):
        load_demo("--user", "demo", "--password-file", str(path))
    assert not User.objects.exists()
    assert not Uav.objects.exists()


def test_a_missing_password_file_is_refused_in_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match="cannot be read: No such file"):
        load_demo("--user", "demo", "--password-file", str(tmp_path / "nothing"))
