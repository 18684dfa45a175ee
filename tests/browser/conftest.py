"""A whole installation started by ./run with real data, and Chromium in front of it."""

import os
import shutil
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, ConsoleMessage, Page, expect, sync_playwright

from scripts.places import Places
from scripts.system_packages import BROWSERS

PROJECT_DIR = Path(__file__).resolve().parents[2]
# findings: the quickest flags of those that render WebGL in Debian's Chromium without a graphics card
CHROMIUM_FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync",
]  # fmt: skip
PATIENCE_MS = 45_000  # ./check runs other tests beside these
expect.set_options(timeout=PATIENCE_MS)
PICTURE_SETTLES_MS = 800  # for documentation alone: a change of theme reaches the map a few frames later
PASSWORD = "inspect-the-lines"
USERS = {"opal": "operator", "rory": "operator", "vera": "viewer", "cora": "curator", "ada": "administrator"}
NEW_USERS = f"""
from workspace.models import User
for name, role in {USERS!r}.items():
    User.objects.create_user(name, password={PASSWORD!r}, role=role)
"""


@dataclass(frozen=True)
class Site:
    """Where it is, and the cookies of those who have come in: only the first of their tests goes through the door.

    `does(code)` runs Python in the installation, for what no page can bring about. Vehicles speak to its gateway by UDP.
    """

    address: str
    does: Callable[[str], None]
    gateway_port: int
    cookies: dict[str, list[Any]] = field(default_factory=dict)


def _free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    with socket.socket(type=kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@pytest.fixture(scope="session")
def site(shared_data: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """Columbus, Ohio, with two zones, behind the real front door: proxy, policy headers, workers. Without a base map from outside."""
    osm_file = shared_data("osm/columbus-ohio.osm.pbf")
    state_dir = tmp_path_factory.mktemp("site")
    environment = {name: value for name, value in os.environ.items() if name not in {"DATABASE_URL", "REDIS_URL", "DJANGO_SETTINGS_MODULE"}}
    port, gateway_port = _free_port(), _free_port(socket.SOCK_DGRAM)
    environment |= {"SPANWISE_VAR": str(state_dir), "SPANWISE_BASE_MAP_TILES": ""}
    environment |= {"SPANWISE_GATEWAY_UDP": f"127.0.0.1:{gateway_port}", "SPANWISE_GATEWAY_TCP": ""}
    zones_file = Path(__file__).with_name("zones.geojson")

    def run(*command: str) -> None:
        done = subprocess.run(command, cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, timeout=300, check=False)  # noqa: S603
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"

    try:
        run("./run", "--detach", "--port", str(port), "--osm", str(osm_file), "--zones", str(zones_file))
        does = partial(run, sys.executable, "manage.py", "shell", "-v", "0", "-c")
        does(NEW_USERS)
        yield Site(address=f"http://127.0.0.1:{port}", does=does, gateway_port=gateway_port)
    finally:
        run("./run", "--stop")
        shutil.rmtree(Places(state_dir).data, ignore_errors=True)  # as root the database may stand outside the state folder


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    assert program, "Chromium is missing; ./check installs it"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=CHROMIUM_FLAGS)
        yield browser
        browser.close()


@dataclass
class Visitor:
    """Somebody at a browser. What their pages complained about, and what they asked of other hosts, is kept."""

    site: Site
    browser: Browser
    complaints: list[str] = field(default_factory=list)
    requests_outside: list[str] = field(default_factory=list)

    def opens(
        self,
        path: str = "/sign-in",
        *,
        size: tuple[int, int] = (1440, 900),
        theme: str = "light",
        touch: bool = False,
        cookies: list[Any] | None = None,
    ) -> Page:
        context = self.browser.new_context(
            base_url=self.site.address,
            viewport={"width": size[0], "height": size[1]},
            color_scheme=theme,
            has_touch=touch,
            reduced_motion="reduce",
        )
        if cookies:
            context.add_cookies(cookies)
        page = context.new_page()
        page.set_default_timeout(PATIENCE_MS)
        page.on("console", self._heard)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._asked(request.url))
        page.goto(path)
        return page

    def signs_in(self, name: str, **how: object) -> Page:
        """The page of missions; without the door where it has been passed before and nobody has closed the session since."""
        page = self.opens("/", cookies=self.site.cookies.get(name), **how)  # type: ignore[arg-type]
        if page.locator("form[action$='sign-in'], input[name=password]").count():
            page.get_by_label("User name").fill(name)
            page.get_by_label("Password").fill(PASSWORD)
            page.get_by_role("button", name="Sign in").click()
        expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
        page.locator("html[data-loaded]").wait_for(state="attached")  # the page listens to keys
        self.site.cookies[name] = page.context.cookies()
        return page

    def _heard(self, message: ConsoleMessage) -> None:
        if message.type == "error" or (message.type == "warning" and "GL Driver Message" not in message.text):
            self.complaints.append(message.text)

    def _asked(self, url: str) -> None:
        if not url.startswith((self.site.address, "data:", "blob:")):
            self.requests_outside.append(url)


@pytest.fixture
def visitor(site: Site, chromium: Browser) -> Iterator[Visitor]:
    somebody = Visitor(site, chromium)
    yield somebody
    for context in chromium.contexts:
        context.close()
    assert somebody.complaints == []
    assert somebody.requests_outside == []


@pytest.fixture
def picture() -> Callable[[Page, str], None]:
    """Writes a screenshot for the documentation when SPANWISE_SCREENSHOTS=1."""

    def take(page: Page, name: str) -> None:
        if os.environ.get("SPANWISE_SCREENSHOTS") == "1":
            page.evaluate("document.activeElement?.blur()")
            page.mouse.move(0, 0)
            page.wait_for_timeout(PICTURE_SETTLES_MS)
            page.screenshot(path=PROJECT_DIR / "docs" / "screenshots" / f"{name}.png")

    return take
