"""Every text of the program is translatable, and each language has all of them."""

import re
from pathlib import Path

import pytest
from django.conf import settings

from config.environment import languages
from scripts.development import texts

PLACEHOLDER = re.compile(r"\{(\w+)\}|%\((\w+)\)[sd]")
NOT_FOR_PEOPLE = re.compile(
    r"\{% blocktranslate.*?endblocktranslate %\}|\{% block body_class %\}.*?\{% endblock %\}|\{%.*?%\}|\{\{.*?\}\}|\{#.*?#\}|<!--.*?-->",
    re.S,
)
ELEMENT = re.compile(r"<(script|style|code|kbd|svg)\b.*?</\1>|<[^<>]*>|\b[a-z-]+=\"[^\"]*\"", re.S)
ATTRIBUTES = re.compile(r'(?:aria-label|title|placeholder|alt)="([^"]*)"')
SCRIPT_LITERAL = re.compile(r'(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<quoted>"(?:[^"\\\n]|\\.)*"|`(?:[^`\\]|\\.)*`)', re.S)
SENTENCE = re.compile(r"^\W*[A-Z][a-z]* [a-z]{2,}|[a-z]{2,} [a-z]{2,} [a-z]+[.?!]$|^\W*[A-Z][a-z]+[.?!]$")
FOR_DEVELOPERS = re.compile(r"(?:Error|RegExp)\(\s*$")
SERVER_WORDS = {"${operator} railway", " It is locked to others: the run is left out as a whole."}  # compared with what the server says
OWN_NAMES = {"Spanwise", "Spanwise administration", "English", "UTC", "CSV", "GeoJSON", "GPX", "KML"}


def _placeholders(text: str) -> set[str]:
    return {braces or percent for braces, percent in PLACEHOLDER.findall(text)}


@pytest.mark.parametrize("language", texts.languages())
def test_every_text_of_the_program_is_translated(language: str) -> None:
    assert texts.missing(language) == []


@pytest.mark.parametrize("language", texts.languages())
def test_no_translation_is_left_of_a_text_that_is_gone(language: str) -> None:
    assert texts.left_over(language) == []


@pytest.mark.parametrize("language", texts.languages())
def test_a_translation_has_the_placeholders_of_its_text(language: str) -> None:
    messages = [message for domain in texts.DOMAINS for message in texts.translations(language, domain)]
    translated = [(texts.forms(message.id)[-1], message.string) for message in messages]
    wrong = [
        text for text, forms in translated if not all(_placeholders(form) <= _placeholders(text) | {"count"} for form in texts.forms(forms))
    ]
    wrong += [text for text, forms in translated if _placeholders(text) - _placeholders(texts.forms(forms)[-1]) - {"count"}]
    assert wrong == []


@pytest.mark.parametrize(("language", "singular"), [("de", {1}), ("es", {1}), ("fr", {0, 1})])
def test_a_compiled_catalogue_has_the_plural_forms_of_its_language(language: str, singular: set[int]) -> None:
    module = texts.module_of(texts.catalogue(language, "djangojs"))
    rule = re.search(r"Number\((.*)\);", module)
    assert rule is not None
    assert {n for n in range(5) if not eval(rule[1], {}, {"n": n})} == singular  # noqa: S307 - our own file, a comparison of numbers
    assert '"Done|job": ' in module, "a context is part of the key"


def test_a_language_is_added_by_its_files_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(texts, "LOCALE", tmp_path / "locale")
    monkeypatch.setattr(texts, "COMPILED_SCRIPTS", tmp_path / "compiled")
    (tmp_path / "locale" / "it" / "LC_MESSAGES").mkdir(parents=True)  # what another branch has left behind
    texts.update("pt_BR")
    assert texts.languages() == ["pt_BR"]
    assert languages(tmp_path / "locale") == [("en", "English"), ("pt-br", "Português Brasileiro")]
    assert {"Sign in", "Done|job"} <= set(texts.missing("pt_BR"))
    file = texts.po_file("pt_BR", "djangojs")
    file.write_text(file.read_text().replace('msgctxt "job"\nmsgid "Done"\nmsgstr ""', 'msgctxt "job"\nmsgid "Done"\nmsgstr "Concluído"'))
    texts.compile_all()
    assert '"Done|job": "Concluído"' in (tmp_path / "compiled" / "pt-br.js").read_text()
    assert languages(Path(settings.LOCALE_PATHS[0])) == settings.LANGUAGES


def _templates() -> list[Path]:
    return sorted(texts.TEMPLATES.rglob("*.html"))


@pytest.mark.parametrize("template", _templates(), ids=lambda path: str(path.relative_to(texts.TEMPLATES)))
def test_a_template_has_no_text_that_cannot_be_translated(template: Path) -> None:
    source = NOT_FOR_PEOPLE.sub("", template.read_text())
    words = [line.strip(" ·\n") for line in (*ATTRIBUTES.findall(source), *ELEMENT.sub("\n", source).split("\n"))]
    assert [line for line in words if re.search(r"[A-Za-z]{2}", re.sub(r"&\w+;", "", line)) and line not in OWN_NAMES] == []


def _untranslated(source: str) -> list[str]:
    """Literals of a script that read like a sentence and are no text of t() or tn()."""
    known = {form for text in texts.texts_of_script(source) for form in texts.forms(text)}
    found = []
    for match in SCRIPT_LITERAL.finditer(source):
        literal = (match["quoted"] or "")[1:-1]
        isolated = re.sub(r"\$\{(?:[^{}]|\{[^{}]*\})*\}", "X", literal)
        if SENTENCE.search(isolated) and literal not in known | SERVER_WORDS and not FOR_DEVELOPERS.search(source[: match.start()]):
            found.append(literal)
    return found


def _scripts() -> list[Path]:
    return sorted(path for path in texts.SCRIPTS.rglob("*.js") if "locale" not in path.relative_to(texts.SCRIPTS).parts)


def test_scripts_have_no_sentence_that_cannot_be_translated() -> None:
    assert {str(path.relative_to(texts.SCRIPTS)): found for path in _scripts() if (found := _untranslated(path.read_text()))} == {}


def test_untranslated_sentences_of_a_script_are_found() -> None:
    source = 'toast("The name is taken."); // It is free.\nsay(t("Saved it.")); say(`Moved it ${n} m.`); new Error("It is not there.");'
    assert _untranslated(source) == ["The name is taken.", "Moved it ${n} m."]


def test_texts_are_found_in_scripts_templates_and_modules() -> None:
    assert list(texts.texts_of_script('t("One"); f(tn(f(a, b), "{count} x", "{count} xs"));')) == [
        "One",
        ("{count} x", "{count} xs"),
    ]
    assert list(texts.texts_of_module('_("One"); ngettext("%(count)s a", "%(count)s b", n); other("Two")')) == [
        "One",
        ("%(count)s a", "%(count)s b"),
    ]
