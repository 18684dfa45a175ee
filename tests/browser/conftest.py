"""A whole installation started by ./run with the data of a region, and Chromium in front of it."""

import json
import math
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext, ConsoleMessage, Page, expect, sync_playwright
from playwright.sync_api import Error as PlaywrightError

from accounts.login import REAUTHENTICATION_S
from scripts.installation.system_packages import BROWSERS
from scripts.places import Places
from tests.accounts.single_sign_on.openid_provider import settings_of_provider
from tests.browser.chromium import CHROMIUM_FLAGS
from tests.browser.pictures import HAS_PICTURES, save_picture
from tests.browser.regions import region

PROJECT_DIR = Path(__file__).resolve().parents[2]
TIMEOUT_MS = 45_000  # ./check runs other tests beside these
expect.set_options(timeout=TIMEOUT_MS)
# The processor draws maps and the 3D view: with a sixteenth of the pixels a map's page takes half as much of its time. The layout stays.
COARSE_CANVASES = "Object.defineProperty(window, 'devicePixelRatio', { get: () => 0.25 });"
# No test but those with `draws` looks at what WebGL draws: shaders are compiled and buffers filled, the triangles are left out.
NO_TRIANGLES = """
    const draws = ["drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"];
    for (const { prototype } of [WebGLRenderingContext, WebGL2RenderingContext])
        for (const name of draws) if (prototype[name]) prototype[name] = () => undefined;
"""
# Ten frames a second: a map draws sixty a second while it moves, each of which takes time of the processor in four processes of Chromium.
FEW_FRAMES = """
    {
        const nextFrame = window.requestAnimationFrame.bind(window);
        const waiting = new Map();
        let [number, drawn_ms, isAsked] = [0, -Infinity, false];
        const draw = (now_ms) => {
            [drawn_ms, isAsked] = [performance.now(), false];
            for (const [asked, callback] of [...waiting]) // what is asked for meanwhile is of the next frame
                if (waiting.delete(asked)) try { callback(now_ms); } catch (error) { reportError(error); }
        };
        window.requestAnimationFrame = (callback) => {
            waiting.set(++number, callback);
            if (!isAsked) setTimeout(() => nextFrame(draw), Math.max(0, drawn_ms + 100 - performance.now()));
            isAsked = true;
            return number;
        };
        window.cancelAnimationFrame = (asked) => waiting.delete(asked);
    }
"""
DESK = {"width": 1440, "height": 900}
STORAGES = "local_storage,indexeddb,service_workers,cache_storage,file_systems"  # of Storage.clearDataForOrigin in Chrome's protocol
EMPTY_PAGE = "about:blank"
NO_COMPLAINTS = ("GL Driver Message", "Service Worker registration blocked by Playwright")
PICTURE_SETTLES_MS = 800  # for documentation alone: a change of theme reaches the map a few frames later
MAX_TEST_S = 300.0
PASSWORD = "inspect-the-lines"
USERS = {"opal": "operator", "rory": "operator", "vera": "viewer", "cora": "curator", "ada": "administrator"}
NEW_USERS = f"""
from workspace.models import User
for name, role in {USERS!r}.items():
    User.objects.create_user(name, password={PASSWORD!r}, role=role)
"""
MADE_DATA = """
from inspection.models import DataImport, ImportKind
from inspection.services.imports.osm import SYNTHETIC_ATTRIBUTION
DataImport.objects.filter(kind=ImportKind.OSM).update(is_synthetic=True, attribution=SYNTHETIC_ATTRIBUTION)
"""
NO_LEFTOVERS = """
from django.apps import apps
from django.db import connection
models = [model for app in ("missions", "telemetry", "results", "simulation") for model in apps.get_app_config(app).get_models()]
with connection.cursor() as cursor:
    cursor.execute(f"TRUNCATE {', '.join(model._meta.db_table for model in models)}")
"""


@dataclass(frozen=True)
class Site:
    """Where it is, and who came in when, with their cookies: only the first of their tests within REAUTHENTICATION_S goes through the door.

    `does(code)` runs Python in the installation, for what no page can bring about. Vehicles speak to its gateway by UDP. Its identity
    provider is expected at a port of this machine, where a test may start one.
    """

    address: str
    does: Callable[[str], None]
    gateway_port: int
    provider_port: int
    came_in: dict[str, tuple[float, list[Any]]] = field(default_factory=dict)


def _free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    with socket.socket(type=kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _run(environment: dict[str, str], *command: str) -> None:
    done = subprocess.run(command, cwd=PROJECT_DIR, env=environment, capture_output=True, text=True, timeout=300, check=False)  # noqa: S603
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"


def _environment(state: Path) -> dict[str, str]:
    own = {name: value for name, value in os.environ.items() if name not in {"DATABASE_URL", "REDIS_URL", "DJANGO_SETTINGS_MODULE"}}
    return own | {"SPANWISE_VAR": str(state), "SPANWISE_BASE_MAP_TILES": "", "SPANWISE_GATEWAY_TCP": ""}


def _site_on(state: Path, port: int, gateway_port: int, provider_port: int) -> Site:
    does = partial(_run, _environment(state), sys.executable, "manage.py", "shell", "-v", "0", "-c")
    return Site(address=f"http://127.0.0.1:{port}", does=does, gateway_port=gateway_port, provider_port=provider_port)


def _start_site(state: Path, shared_data: Callable[[str], Path]) -> Site:
    """Start an installation with the region's infrastructure, two zones and no base map from outside."""
    osm_files, zones_file = region.write_files(state, shared_data)
    osm = [argument for path in osm_files for argument in ("--osm", str(path))]
    port, gateway_port, provider_port = _free_port(), _free_port(socket.SOCK_DGRAM), _free_port()
    environment = _environment(state) | {"SPANWISE_GATEWAY_UDP": f"127.0.0.1:{gateway_port}"} | settings_of_provider(provider_port)
    _run(environment, "./run", "--detach", "--port", str(port), *osm, "--zones", str(zones_file))
    started = _site_on(state, port, gateway_port, provider_port)
    started.does(NEW_USERS if region.real_file else NEW_USERS + MADE_DATA)
    return started


def _kept_site(state: Path, shared_data: Callable[[str], Path]) -> Site:
    """Return the installation that an earlier run has started on this state, or start one that is left running."""
    note = state / "site.json"
    status = [PROJECT_DIR / "run", "--status", "--var", state]
    if note.exists() and subprocess.run(status, capture_output=True, check=False).returncode == 0:  # noqa: S603
        known = json.loads(note.read_text())
        assert known["region"] == region.name, f"{state} has the region {known['region']}"
        kept = _site_on(state, known["port"], known["gateway_port"], known["provider_port"])
        kept.does(NO_LEFTOVERS)
        return kept
    assert note.exists() or not state.exists(), f"{state} is no site of these tests"
    if state.exists():
        _run(_environment(state), "./run", "--stop")
        shutil.rmtree(Places(state).data, ignore_errors=True)
        shutil.rmtree(state)
    state.mkdir(parents=True)
    note.write_text("{}")
    started = _start_site(state, shared_data)
    ports = {"port": urlsplit(started.address).port, "gateway_port": started.gateway_port, "provider_port": started.provider_port}
    note.write_text(json.dumps({"region": region.name, **ports}))
    return started


@pytest.fixture(scope="session")
def site(shared_data: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory) -> Iterator[Site]:
    """The region behind the real proxy, policy headers and workers. With SPANWISE_TEST_SITE=DIR it is left running for the next run."""
    if kept := os.environ.get("SPANWISE_TEST_SITE"):
        yield _kept_site(Path(kept).resolve() / os.environ.get("PYTEST_XDIST_WORKER", ""), shared_data)
        return
    state = tmp_path_factory.mktemp("site")
    try:
        yield _start_site(state, shared_data)
    finally:
        _run(_environment(state), "./run", "--stop")
        shutil.rmtree(Places(state).data, ignore_errors=True)  # as root the database may stand outside the state folder


@pytest.fixture(scope="module")
def without_leftovers(site: Site) -> None:
    """Delete the missions, UAVs, flights and simulations of other files' tests."""
    site.does(NO_LEFTOVERS)


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    assert program, "Chromium is missing; ./check installs it"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=CHROMIUM_FLAGS)
        yield browser
        browser.close()


class ContextPool:
    """Browser contexts that one test leaves to the next, emptied of all but what the browser has cached of the static files."""

    def __init__(self, browser: Browser, address: str) -> None:
        self.browser, self.address = browser, address
        self._idle: dict[bool, list[BrowserContext]] = {True: [], False: []}

    def new(self, *, draws: bool = False, **options: Any) -> BrowserContext:
        """A context of its own, which is closed after the test; WebGL's triangles are drawn in one that `draws`.

        Without a service worker unless `service_workers="allow"`: tests of faults answer the requests of pages themselves.
        """
        options = {"service_workers": "block", "base_url": self.address} | options
        context = self.browser.new_context(reduced_motion="reduce", **options)
        if not HAS_PICTURES:
            context.add_init_script(COARSE_CANVASES)
            if not draws:
                context.add_init_script(NO_TRIANGLES)
                context.add_init_script(FEW_FRAMES)
        return context

    def take(self, *, touch: bool) -> BrowserContext:
        idle = self._idle[touch]
        return idle.pop() if idle else self.new(viewport=DESK, has_touch=touch)

    def release(self, context: BrowserContext, *, touch: bool) -> None:
        """Close its pages, empty it and keep it; close it where that fails."""
        try:
            for page in context.pages:
                page.close()
            context.set_offline(False)
            context.clear_cookies()
            context.clear_permissions()
            page = context.new_page()
            wiped = {"origin": self.address, "storageTypes": STORAGES}
            context.new_cdp_session(page).send("Storage.clearDataForOrigin", wiped)
            page.close()
            self._idle[touch].append(context)
        except PlaywrightError:  # the test has closed it
            context.close()


@dataclass
class Visitor:
    """Somebody at a browser. What their pages complained about, and what they asked of other hosts, is kept."""

    site: Site
    contexts: ContextPool
    complaints: list[str] = field(default_factory=list)
    complained_of: list[str] = field(default_factory=list)  # addresses of the console's messages
    requests_outside: list[str] = field(default_factory=list)
    taken: list[tuple[BrowserContext, bool]] = field(default_factory=list)
    own: list[BrowserContext] = field(default_factory=list)

    def new_context(self, **options: Any) -> BrowserContext:
        """A context that no other test has used or will use."""
        self.own.append(self.contexts.new(**options))
        return self.own[-1]

    def leaves(self) -> None:
        """Close what was opened."""
        for context in self.own:
            context.close()
        for context, touch in self.taken:
            self.contexts.release(context, touch=touch)
        self.own.clear()
        self.taken.clear()

    def opens(
        self,
        path: str = "/sign-in",
        *,
        size: tuple[int, int] = (1440, 900),
        theme: str = "light",
        touch: bool = False,
        draws: bool = False,
        cookies: list[Any] | None = None,
    ) -> Page:
        if draws:
            context = self.new_context(draws=True, has_touch=touch)
        else:
            context = self.contexts.take(touch=touch)
            self.taken.append((context, touch))
        if cookies:
            context.add_cookies(cookies)
        page = context.new_page()
        page.set_viewport_size({"width": size[0], "height": size[1]})
        page.emulate_media(color_scheme=theme)  # type: ignore[arg-type]
        page.set_default_timeout(TIMEOUT_MS)
        page.on("console", self._received)
        page.on("pageerror", lambda error: self.complaints.append(str(error)))
        page.on("request", lambda request: self._asked(request.url))
        page.goto(path)
        return page

    def signs_in(self, name: str, path: str = EMPTY_PAGE, **how: Any) -> Page:
        """A page of this user, empty unless it is named; by signing in, or with the session of an earlier test that is still open."""
        since_s, cookies = self.site.came_in.get(name, (-math.inf, []))
        page = self.opens(EMPTY_PAGE, cookies=cookies, **how)
        is_recent = time.monotonic() - since_s < REAUTHENTICATION_S - MAX_TEST_S  # what wants the password again some minutes later
        if not is_recent or not page.request.get("/api/v1/account").ok:
            since_s = time.monotonic()
            page.context.clear_cookies()
            page.goto("/sign-in")
            page.get_by_label("User name").fill(name)
            page.get_by_label("Password").fill(PASSWORD)
            page.get_by_role("button", name="Sign in").click()
            expect(page.get_by_role("heading", name="Missions", exact=True)).to_be_visible()
            page.goto(EMPTY_PAGE)
        if path != EMPTY_PAGE:
            page.goto(path)
            page.locator("html[data-loaded]").wait_for(state="attached")  # the page listens to keys
        self.site.came_in[name] = since_s, page.context.cookies()
        return page

    def _received(self, message: ConsoleMessage) -> None:
        if message.type == "error" or (message.type == "warning" and not any(words in message.text for words in NO_COMPLAINTS)):
            self.complaints.append(message.text)
            self.complained_of.append(str(message.location.get("url", "")))

    def _asked(self, url: str) -> None:
        if not url.startswith((self.site.address, "data:", "blob:", "about:")):
            self.requests_outside.append(url)


@pytest.fixture(scope="session")
def contexts(site: Site, chromium: Browser) -> ContextPool:
    return ContextPool(chromium, site.address)


@pytest.fixture
def visitor(site: Site, contexts: ContextPool) -> Iterator[Visitor]:
    a_user = Visitor(site, contexts)
    yield a_user
    a_user.leaves()
    assert a_user.complaints == [], a_user.complained_of
    assert a_user.requests_outside == []


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is for the documentation alone, unless pictures are asked for."""
    left_out = [item for item in items if not HAS_PICTURES and item.get_closest_marker("pictures")]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in left_out]


@pytest.fixture
def picture() -> Callable[[Page, str], None]:
    """Save a screenshot when SPANWISE_SCREENSHOTS=1."""

    def take(page: Page, name: str) -> None:
        if HAS_PICTURES:
            page.evaluate("document.activeElement?.blur()")
            page.mouse.move(0, 0)
            page.wait_for_timeout(PICTURE_SETTLES_MS)
            save_picture(page.screenshot(), name)

    return take
