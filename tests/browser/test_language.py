"""The program in other languages: no English is left on any page, for the eye and for a screen reader, but what is marked as English."""

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from scripts.development import texts
from tests.browser.conftest import PASSWORD, Visitor
from tests.browser.operator_map import asks, wait_for_map
from tests.browser.page_lists import FOR_OPERATORS, FOR_STRANGERS
from tests.browser.regions import region

pytestmark = [pytest.mark.browser, pytest.mark.usefixtures("without_leftovers")]

STATED = """() => {
    const said = new Set();
    const add = (words) => words && said.add(words.replace(/\\s+/g, " ").trim());
    const roots = [document.body, ...[...document.querySelectorAll("template")].map((template) => template.content)];
    for (const root of roots) {
        const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
        while (walker.nextNode()) {
            const { data, parentElement } = walker.currentNode;
            if (!parentElement?.closest("script, style, code, kbd, [translate=no], [lang=en]")) add(data);
        }
        for (const element of root.querySelectorAll("*")) {
            for (const name of ["aria-label", "title", "placeholder", "alt"]) add(element.getAttribute(name));
        }
    }
    add(document.title);
    return [...said].filter((words) => /[A-Za-z]{2}/.test(words));
}"""
# Two of these in one text, and it is a sentence in English. What people and files have named is not looked at so closely: missions and
# UAVs that other tests have named in English are deleted first.
ENGLISH = re.compile(
    r"\b(?:the|of|and|is|are|not|with|this|that|which|has|have|been|from|nothing|each|where|what|you|your)\b", re.IGNORECASE
)
PLACEHOLDER = re.compile(r"\{\w+\}|%\(\w+\)[sd]")


def _patterns(language: str) -> re.Pattern[str]:
    """All texts in English whose translation is another one; what is put in may be anything."""
    pairs: list[tuple[str, str]] = []
    for domain in texts.DOMAINS:
        for message in texts.translations(language, domain):
            english_forms, own_forms = texts.forms(message.id), texts.forms(message.string)
            pairs += [(english_forms[0], form) for form in (own_forms if domain == "djangojs" else own_forms[:1])]
    english = {text for text, own in pairs if text != own} - {own for _, own in pairs}
    written = {
        text for text in english if len(re.findall(r"[A-Za-z]", PLACEHOLDER.sub("", text))) >= (1 if not PLACEHOLDER.search(text) else 8)
    }
    return re.compile("|".join(".+?".join(map(re.escape, PLACEHOLDER.split(text))) for text in sorted(written)))


class Reader:
    """Reads pages aloud and keeps what is English."""

    def __init__(self, language: str = "de") -> None:
        self.language = language
        self.english = _patterns(language)
        self.found: dict[str, list[str]] = {}

    def reads(self, page: Page, what: str) -> None:
        left = [words for words in page.evaluate(STATED) if self.english.fullmatch(words) or len(set(ENGLISH.findall(words.lower()))) > 1]
        if left:
            self.found[what] = left

    def opens(self, page: Page, path: str) -> None:
        page.goto(path)
        if page.locator("script[type=module]").count():
            page.locator("html[data-loaded]").wait_for(state="attached")
        expect(page.locator("html")).to_have_attribute("lang", self.language)
        self.reads(page, path)


def _german(visitor: Visitor, name: str | None = None, *, size: tuple[int, int] = (1440, 900)) -> Page:
    page = visitor.new_context(locale="de-DE", viewport={"width": size[0], "height": size[1]}).new_page()
    page.set_default_timeout(45_000)
    page.on("pageerror", lambda error: visitor.complaints.append(str(error)))
    page.goto("/sign-in")
    if name:
        page.get_by_label("Benutzername").fill(name)
        page.get_by_label("Passwort").fill(PASSWORD)
        page.get_by_role("button", name="Anmelden").click()
        expect(page.get_by_role("heading", name="Missionen", exact=True)).to_be_visible()
    return page


def _stores_mission(page: Page, **rest: Any) -> str:
    tower = asks(page, f"/assets?kind=tower&bbox={region.towers}&limit=3&flyable=true")["features"]
    uav = asks(page, "/uavs")["features"]
    token = page.evaluate("document.cookie.match(/csrftoken=([^;]*)/)[1]")
    body = {
        "name": "Prüfung",
        "targets": [{"asset": feature["id"]} for feature in tower],
        "uavs": [{"id": uav[0]["id"]}] if uav else [{"position": region.beside_tower, "name": "Milan"}],
        "plan": True,
        **rest,
    }
    answer = page.request.post("/api/v1/missions", data=body, headers={"X-CSRFToken": token, "Referer": page.url})
    assert answer.ok, answer.text()
    return str(answer.json()["id"])


@pytest.mark.long
def test_no_english_is_left_on_the_pages_of_an_operator(visitor: Visitor, picture: Callable[[Page, str], None]) -> None:
    reader = Reader()
    stranger = _german(visitor)
    for path in (*FOR_STRANGERS, "/new-password/x/y", "/invitation/unknown"):
        reader.opens(stranger, path)
    page = _german(visitor, "opal")
    mission = _stores_mission(page)
    for path in FOR_OPERATORS:
        reader.opens(page, path)
    reader.opens(page, f"/missions/{mission}")
    wait_for_map(page)
    reader.reads(page, "a planned mission")
    picture(page, "plan-german")
    page.keyboard.press("?")
    expect(page.get_by_role("dialog", name="Tastatur")).to_be_visible()
    reader.reads(page, "the keys of the mission")
    page.keyboard.press("Escape")
    page.locator("#open-layers").click()
    reader.reads(page, "the layers")
    assert reader.found == {}


@pytest.mark.long
@pytest.mark.parametrize(("language", "sign_in"), [("es", "Iniciar sesión"), ("fr", "Se connecter")])
def test_main_pages_are_in_the_language_of_the_browser(
    visitor: Visitor, picture: Callable[[Page, str], None], language: str, sign_in: str
) -> None:
    reader = Reader(language)
    page = visitor.new_context(locale=language, viewport={"width": 1440, "height": 900}).new_page()
    page.set_default_timeout(45_000)
    reader.opens(page, "/sign-in")
    picture(page, f"sign-in-{language}")
    page.locator("#id_login").fill("opal")
    page.locator("#id_password").fill(PASSWORD)
    page.get_by_role("button", name=sign_in).click()
    page.locator("html[data-loaded]").wait_for(state="attached")
    mission = _stores_mission(page)
    for path in ("/", "/live", "/uavs", "/account", f"/missions/{mission}"):
        reader.opens(page, path)
        picture(page, f"{path.strip('/').split('/')[0] or 'missions'}{'-plan' if mission in path else ''}-{language}")
    assert reader.found == {}


@pytest.mark.long
def test_no_english_is_left_on_the_pages_of_a_curator_and_an_administrator(visitor: Visitor) -> None:
    reader = Reader()
    page = _german(visitor, "cora")
    for kind in ("tower", "line", "railway", "bridge"):
        asset = asks(page, f"/assets?kind={kind}&limit=1")["features"][0]["id"]
        reader.opens(page, f"/assets?id={asset}")
        page.locator("#record-show h2").wait_for()
        reader.reads(page, f"a {kind}")
    page.keyboard.press("e")
    page.locator("#record-edit h2").wait_for()
    reader.reads(page, "an asset that is edited")
    zone = asks(page, "/zones?limit=1")["features"][0]["id"]
    reader.opens(page, f"/zones?id={zone}")
    page.locator("#record-show h2").wait_for()
    reader.reads(page, "a zone")
    page.keyboard.press("e")
    page.locator("#record-edit h2").wait_for()
    reader.reads(page, "a zone that is edited")
    for issue in asks(page, "/data-issues?limit=3")["features"]:
        reader.opens(page, f"/assets/data-issues?issue={issue['id']}")
        page.locator("#issue-panel h2").wait_for()
        reader.reads(page, f"an issue: {issue['properties']['kind']}")
    reader.opens(page, "/imports")
    proposal = asks(page, "/imports?limit=1")["results"]
    if proposal:
        reader.opens(page, f"/imports/{proposal[0]['id']}")
    reader.opens(_german(visitor, "ada"), "/administration")
    assert reader.found == {}
