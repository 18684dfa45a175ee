"""The proxy's configuration: nginx accepts it, and it says what pages may load."""

import subprocess
from pathlib import Path

import pytest

from scripts.installation.system_packages import find_program
from scripts.places import PROGRAMS_WITH_METRICS, CannotStart, Places
from scripts.proxy.page_headers import content_security_policy
from scripts.proxy.proxy import BASE_MAP_TILES, configuration
from scripts.supervision.programs import web_programs


def test_nginx_accepts_the_configuration_even_with_a_blank_in_the_path(tmp_path: Path) -> None:
    nginx = find_program("nginx")
    if nginx is None:
        pytest.skip("nginx is not installed; ./run installs it")
    places = Places(tmp_path / "a state")
    places.process("proxy").mkdir(parents=True)
    path = tmp_path / "nginx.conf"
    path.write_text(configuration(places, tmp_path, 8000))
    answer = subprocess.run([nginx, "-e", "stderr", "-t", "-c", str(path)], capture_output=True, text=True, check=False)
    assert "test is successful" in answer.stderr, answer.stderr


def test_a_path_that_nginx_would_misread_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CannotStart, match="dollar"):
        configuration(Places(tmp_path / "$uri"), tmp_path, 8000)


def test_pages_may_run_no_script_that_stands_in_the_page() -> None:
    rules = dict(rule.split(" ", 1) for rule in content_security_policy().split("; "))
    assert rules["script-src"] == "'self'"
    assert rules["worker-src"] == "'self' blob:"
    assert rules["object-src"] == rules["frame-ancestors"] == "'none'"


def test_tile_servers_that_the_settings_name_are_allowed_and_no_others() -> None:
    policy = content_security_policy(["http://tiles.example:8080/{z}/{x}/{y}.png", "https://{s}.tiles.example/{z}", ""])
    assert "connect-src 'self' http://tiles.example:8080 https://*.tiles.example;" in policy
    assert "img-src 'self' data: blob: http://tiles.example:8080 https://*.tiles.example;" in policy
    assert "connect-src 'self';" in content_security_policy()
    for wrong in ("http://evil;script-src/*", "https://*/{z}", "https://{s}./{z}", "https://a@b{z}/", "javascript://x"):
        assert content_security_policy([wrong]) == content_security_policy(), wrong


def test_the_base_map_is_the_one_that_pages_ask_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_BASE_MAP_TILES", raising=False)
    origin = "https://tile.openstreetmap.org"
    assert BASE_MAP_TILES in (Path(__file__).parents[3] / "config" / "settings.py").read_text()
    assert f"connect-src 'self' {origin};" in configuration(Places(tmp_path), tmp_path, 8000)
    monkeypatch.setenv("SPANWISE_BASE_MAP_TILES", "")
    assert "connect-src 'self';" in configuration(Places(tmp_path), tmp_path, 8000)


def test_behind_a_tls_proxy_its_word_on_the_scheme_is_passed_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_HTTPS", raising=False)
    assert "X-Forwarded-Proto $scheme;" in configuration(Places(tmp_path), tmp_path, 8000)
    monkeypatch.setenv("SPANWISE_HTTPS", "1")
    assert "X-Forwarded-Proto $http_x_forwarded_proto;" in configuration(Places(tmp_path), tmp_path, 8000)


def test_behind_a_tls_proxy_the_visitors_address_is_the_one_that_it_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_HTTPS", raising=False)
    assert "$http_x_forwarded_for" not in configuration(Places(tmp_path), tmp_path, 8000)
    monkeypatch.setenv("SPANWISE_HTTPS", "1")
    assert "default $http_x_forwarded_for;" in configuration(Places(tmp_path), tmp_path, 8000)
    test_nginx_accepts_the_configuration_even_with_a_blank_in_the_path(tmp_path)


def test_what_programs_tell_of_themselves_has_a_port_of_its_own_where_it_is_wanted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SPANWISE_METRICS_PORT", raising=False)
    assert "told.sock" not in configuration(Places(tmp_path), tmp_path, 8000)
    monkeypatch.setenv("SPANWISE_METRICS_PORT", "9464")
    text = configuration(Places(tmp_path), tmp_path, 8000)
    assert text.count("listen 127.0.0.1:9464;") == 1
    served_at = {program.environment.get("SPANWISE_METRICS") for program in web_programs(Places(tmp_path), tmp_path)} - {None}
    assert len(served_at) == len(PROGRAMS_WITH_METRICS)
    for place in served_at:
        assert f"{place}:/" in text
    test_nginx_accepts_the_configuration_even_with_a_blank_in_the_path(tmp_path)


def test_a_port_for_metrics_that_is_none_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPANWISE_METRICS_PORT", "all")
    with pytest.raises(CannotStart, match="SPANWISE_METRICS_PORT"):
        configuration(Places(tmp_path), tmp_path, 8000)
