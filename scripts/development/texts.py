"""Texts of pages and responses in other languages: gettext catalogues, one directory in locale/ for each language.

python -m scripts.development.texts compile     make what the program and the pages read; ./run and ./check do it themselves
python -m scripts.development.texts update      add new texts of the program to the .po files, and remove obsolete ones; with names of
                                                languages, such as pt_BR, add their files
python -m scripts.development.texts missing     list texts without a translation
"""

import ast
import io
import json
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from babel.core import Locale
from babel.messages.catalog import Catalog, Message
from babel.messages.extract import extract_javascript
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po
from django.utils.translation import to_language
from django.utils.translation.template import templatize

ROOT = Path(__file__).resolve().parents[2]
LOCALE = ROOT / "locale"
TEMPLATES = ROOT / "templates"
SCRIPTS = ROOT / "static" / "js"
COMPILED_SCRIPTS = SCRIPTS / "locale"
APPS = (
    "operation",
    "config",
    "workspace",
    "accounts",
    "inspection",
    "planning",
    "mavlink",
    "missions",
    "telemetry",
    "results",
    "simulation",
)

Text = str | tuple[str, str]  # the second form has a plural; in scripts "|hint" names the meaning of a word, the context in a .po file

Calls = dict[str, None]
OF_SERVER: Calls = dict.fromkeys(("_", "gettext", "gettext_lazy", "gettext_noop", "ngettext", "ngettext_lazy", "ngettext_noop"))
OF_SCRIPTS: Calls = dict.fromkeys(("t", "tn"))
CALL_IN_SCRIPT = re.compile(r"(?<![\w.$])tn?\(")
UNSTABLE = "POT-Creation-Date|PO-Revision-Date|Last-Translator|Language-Team|Generated-By|Report-Msgid-Bugs-To"
UNSTABLE_HEADER = re.compile(rf'^"(?:{UNSTABLE}): .*\n', re.M)


# --- texts of the program -------------------------------------------------------------------------------------------------------


def texts_of_templates() -> Iterator[Text]:
    for path in sorted(TEMPLATES.rglob("*.html")) + sorted(TEMPLATES.rglob("*.txt")):
        yield from texts_of_template(path.read_text())


def texts_of_template(source: str) -> Iterator[Text]:
    """Django makes calls of gettext from its tags, between words that Babel's extractor for JavaScript passes over."""
    for _, function, arguments, _ in extract_javascript(io.BytesIO(templatize(source).encode()), OF_SERVER, (), {"jsx": False}):
        yield from _text(function, arguments)


def texts_of_python() -> Iterator[Text]:
    for app in APPS:
        for path in sorted((ROOT / app).rglob("*.py")):
            if "migrations" not in path.parts:
                yield from texts_of_module(path.read_text())


def texts_of_module(source: str) -> Iterator[Text]:
    """Babel's extractor for Python passes over calls in arguments of other calls, and takes keys of mappings for texts."""
    for call in ast.walk(ast.parse(source)):
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in OF_SERVER:
            yield from _text(call.func.id, [argument.value for argument in call.args if isinstance(argument, ast.Constant)])


def texts_of_scripts() -> Iterator[Text]:
    for path in sorted(SCRIPTS.rglob("*.js")):
        if path.name != "text.js" and COMPILED_SCRIPTS not in path.parents:
            yield from texts_of_script(path.read_text())


def texts_of_script(source: str) -> Iterator[Text]:
    """Babel's extractor passes over calls in arguments of other calls, so each call is extracted by itself."""
    code = re.sub(r"/\*.*?\*/", "", source, flags=re.S)
    for match in CALL_IN_SCRIPT.finditer(code):
        call = io.BytesIO(code[match.start() :].encode())
        for _, function, arguments, _ in extract_javascript(call, OF_SCRIPTS, (), {"jsx": False}):
            yield from _text(function, arguments)
            break


def _text(function: object, arguments: object) -> Iterator[Text]:
    """Return the text of a call: its first literal, or the first two where it has a plural."""
    literals = [argument for argument in _several(arguments) if isinstance(argument, str)]
    if function in ("tn", "ngettext", "ngettext_lazy", "ngettext_noop"):
        if len(literals) > 1:
            yield literals[0], literals[1]
    elif literals:
        yield literals[0]


def _several(one_or_more: object) -> list[Any]:
    return list(one_or_more) if isinstance(one_or_more, list | tuple) else [one_or_more] if one_or_more else []


DOMAINS: dict[str, Callable[[], Iterator[Text]]] = {
    "django": lambda: (text for source in (texts_of_templates, texts_of_python) for text in source()),
    "djangojs": texts_of_scripts,
}


@cache
def program_texts(domain: str) -> Catalog:
    """Return the texts of the program, untranslated."""
    found = Catalog(fuzzy=False)
    for text in DOMAINS[domain]():
        singular, context = text if isinstance(text, str) else text[0], ""
        if domain == "djangojs":
            singular, _, context = singular.partition("|")
        found.add(singular if isinstance(text, str) else (singular, text[1]), context=context or None)
    return found


# --- catalogues -----------------------------------------------------------------------------------------------------------------


def languages() -> list[str]:
    """Return the names of the directories in locale/ with texts, such as "de" or "pt_BR"."""
    return sorted(path.parts[-3] for path in LOCALE.glob("*/LC_MESSAGES/django.po"))


def po_file(language: str, domain: str) -> Path:
    return LOCALE / language / "LC_MESSAGES" / f"{domain}.po"


def catalogue(language: str, domain: str) -> Catalog:
    path = po_file(language, domain)
    if not path.exists():
        heading = f"# {Locale.parse(language).english_name} texts of Spanwise's {'pages' if domain == 'djangojs' else 'server'}."
        return Catalog(locale=language, project="Spanwise", version="1", header_comment=heading, charset="utf-8", fuzzy=False)
    with path.open("rb") as file:
        return read_po(file, locale=language)


def translations(language: str, domain: str) -> list[Message]:
    return [message for message in catalogue(language, domain) if message.id]


def forms(text: object) -> list[str]:
    """Return the one form of a text, or all of one with a plural."""
    return _several(text) or [""]


def missing(language: str) -> list[str]:
    """Return the texts of the program without a translation."""
    found = []
    for domain in DOMAINS:
        known = catalogue(language, domain)
        for wanted in program_texts(domain):
            message = known.get(forms(wanted.id)[0], wanted.context)
            is_same = message is not None and isinstance(message.id, str) == isinstance(wanted.id, str)
            if wanted.id and not (message and is_same and not message.fuzzy and all(forms(message.string))):
                found.append(_key(wanted))
    return found


def left_over(language: str) -> list[str]:
    """Return the texts with a translation that are no longer in the program."""
    found = []
    for domain in DOMAINS:
        used = program_texts(domain)
        found += [_key(message) for message in translations(language, domain) if used.get(forms(message.id)[0], message.context) is None]
    return found


def _key(message: Message) -> str:
    """Return how scripts name a text: "Operator|role"."""
    return forms(message.id)[0] + (f"|{message.context}" if message.context else "")


def update(*new_languages: str) -> None:
    for language in sorted({*languages(), *new_languages}):
        for domain in DOMAINS:
            kept = catalogue(language, domain)
            kept.update(program_texts(domain), no_fuzzy_matching=True)
            written = io.BytesIO()
            write_po(written, kept, width=120, sort_output=True, ignore_obsolete=True)
            po_file(language, domain).parent.mkdir(parents=True, exist_ok=True)
            po_file(language, domain).write_text(UNSTABLE_HEADER.sub("", written.getvalue().decode()))


# --- compiled -------------------------------------------------------------------------------------------------------------------


def compile_all() -> None:
    COMPILED_SCRIPTS.mkdir(exist_ok=True)
    for language in languages():
        with po_file(language, "django").with_suffix(".mo").open("wb") as file:
            write_mo(file, catalogue(language, "django"))
        (COMPILED_SCRIPTS / f"{to_language(language)}.js").write_text(module_of(catalogue(language, "djangojs")))


def module_of(texts: Catalog) -> str:
    """Return a catalogue as the module that text.js loads. A rule for plurals means the same in C and in JavaScript."""
    translated = {_key(message): message.string for message in texts if message.id and all(forms(message.string)) and not message.fuzzy}
    return (
        "/** Compiled by scripts/development/texts.py. */\n"
        f"export const form = (/** @type {{number}} */ n) => Number({texts.plural_expr});\n"
        f"export default {json.dumps(translated, ensure_ascii=False, indent=0)};\n"
    )


def main(arguments: list[str]) -> int:
    match arguments:
        case ["compile"]:
            compile_all()
        case ["update", *new_languages]:
            update(*new_languages)
        case ["missing"]:
            found = {language: missing(language) for language in languages()}
            print(json.dumps(found, ensure_ascii=False, indent=1))
            return int(any(found.values()))
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
