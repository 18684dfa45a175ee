"""Translations of pages and responses: find texts, and compile .po files to the .mo files that the program reads.

python -m scripts.development.texts compile     make the .mo files; ./run and ./check do it themselves
python -m scripts.development.texts update      add new texts of the program to the .po files, and remove obsolete ones
python -m scripts.development.texts missing     list texts without a translation, those of the pages' scripts included
"""

import ast
import io
import json
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import django
from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po
from django.template import Engine, Template
from django.template.base import Node
from django.templatetags.i18n import BlockTranslateNode, TranslateNode

ROOT = Path(__file__).resolve().parents[2]
LANGUAGES = ("de",)
LOCALE = ROOT / "locale"
TEMPLATES = ROOT / "templates"
SCRIPTS = ROOT / "static" / "js"
APPS = ("operation", "config", "workspace", "accounts", "inspection", "planning", "mavlink", "missions", "telemetry", "simulation")

Text = str | tuple[str, str]  # the second form has a plural

_STRING = r'"((?:[^"\\\n]|\\.)*)"'
_SINGLE = re.compile(rf"(?<![\w.$])t\(\s*{_STRING}")
_PLURAL = re.compile(rf"(?<![\w.$])tn\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*?,\s*{_STRING},\s*{_STRING}")
_COUNTED = re.compile(rf"(?<![\w.$])countText\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*?,\s*{_STRING}(?:,\s*{_STRING})?\)")


def po_file(language: str) -> Path:
    return LOCALE / language / "LC_MESSAGES" / "django.po"


def catalogue(language: str) -> Catalog:
    with po_file(language).open("rb") as file:
        return read_po(file, locale=language)


def compile_all() -> None:
    for language in LANGUAGES:
        with po_file(language).with_suffix(".mo").open("wb") as file:
            write_mo(file, catalogue(language))


# --- texts of the program -------------------------------------------------------------------------------------------------------


def texts_of_templates() -> Iterator[Text]:
    engine = Engine.get_default()
    for path in sorted(TEMPLATES.rglob("*.html")) + sorted(TEMPLATES.rglob("*.txt")):
        yield from texts_of_template(path.read_text(), engine)


def texts_of_template(source: str, engine: Engine) -> Iterator[Text]:
    yield from re.findall(r'\b_\("([^"]+)"\)', source)
    for node in _nodes(Template(source, engine=engine).nodelist):
        if isinstance(node, TranslateNode):
            literal = node.filter_expression.var.literal
            if isinstance(literal, str):
                yield literal
        elif isinstance(node, BlockTranslateNode):
            singular, _ = node.render_token_list(node.singular)
            if node.plural:
                yield _trimmed(node, singular), _trimmed(node, node.render_token_list(node.plural)[0])
            else:
                yield _trimmed(node, singular)


def _trimmed(node: BlockTranslateNode, text: str) -> str:
    return " ".join(line.strip() for line in text.splitlines() if line.strip()) if node.trimmed else text


def _nodes(nodes: list[Node]) -> Iterator[Node]:
    for node in nodes:
        yield node
        for name in node.child_nodelists:
            yield from _nodes(getattr(node, name, None) or [])
        for _, branch in getattr(node, "conditions_nodelists", []):
            yield from _nodes(branch)


def texts_of_python() -> Iterator[Text]:
    for app in APPS:
        for path in sorted((ROOT / app).rglob("*.py")):
            if "migrations" not in path.parts:
                yield from texts_of_module(path.read_text())


def texts_of_module(source: str) -> Iterator[Text]:
    for call in ast.walk(ast.parse(source)):
        if not isinstance(call, ast.Call) or not isinstance(call.func, ast.Name):
            continue
        words = [argument.value for argument in call.args if isinstance(argument, ast.Constant) and isinstance(argument.value, str)]
        if call.func.id in {"_", "gettext", "gettext_lazy", "gettext_noop"} and words:
            yield words[0]
        elif call.func.id in {"ngettext", "ngettext_lazy", "ngettext_noop"} and len(words) > 1:
            yield words[0], words[1]


def texts_of_scripts() -> Iterator[Text]:
    for path in sorted(SCRIPTS.rglob("*.js")):
        if path.name != "text.js" and "locale" not in path.relative_to(SCRIPTS).parts:
            yield from texts_of_script(path.read_text())


def texts_of_script(source: str) -> Iterator[Text]:
    code = re.sub(r"/\*.*?\*/", "", source, flags=re.S)
    for match in _SINGLE.finditer(code):
        yield json.loads(f'"{match[1]}"')
    for match in _PLURAL.finditer(code):
        yield json.loads(f'"{match[1]}"'), json.loads(f'"{match[2]}"')
    for match in _COUNTED.finditer(code):
        yield f"{{count}} {match[1]}", f"{{count}} {match[2] or match[1] + 's'}"


# --- catalogues -----------------------------------------------------------------------------------------------------------------


def server_texts() -> list[Text]:
    return list(dict.fromkeys([*texts_of_templates(), *texts_of_python()]))


def script_texts() -> list[Text]:
    return list(dict.fromkeys(texts_of_scripts()))


def script_catalogue(language: str) -> dict[str, str | list[str]]:
    """Return the catalogue of a language, a module with one object, parsed without running it."""
    found: dict[str, str | list[str]] = {}
    for path in sorted((SCRIPTS / "locale" / language).glob("*.js")):
        body = path.read_text().split("export default", 1)[1].strip().rstrip(";")
        body = re.sub(r"^(\s*)([A-Za-z_]\w*):", r'\1"\2":', body, flags=re.M)
        found |= json.loads(re.sub(r",(\s*[}\]])", r"\1", body))
    return found


def missing_in_scripts(language: str) -> list[Text]:
    known = script_catalogue(language)
    single = [text for text in script_texts() if isinstance(text, str)]
    counted = [text for text in script_texts() if not isinstance(text, str)]
    return [text for text in single if not isinstance(known.get(text), str)] + [
        text for text in counted if not isinstance(known.get(text[0]), list)
    ]


def left_over_in_scripts(language: str) -> list[str]:
    used = {text if isinstance(text, str) else text[0] for text in script_texts()}
    return [text for text in script_catalogue(language) if text not in used]


def missing_on_server(language: str) -> list[Text]:
    known = catalogue(language)
    found = {message.id if isinstance(message.id, str) else tuple(message.id): message for message in known if message.id}
    return [text for text in server_texts() if text not in found or not all(_strings(found[text].string)) or found[text].fuzzy]


def left_over_on_server(language: str) -> list[Text]:
    used = set(server_texts())
    ids = [message.id for message in catalogue(language) if message.id]
    texts: list[Text] = [text if isinstance(text, str) else (text[0], text[1]) for text in ids]
    return [text for text in texts if text not in used]


def _strings(string: object) -> list[str]:
    return [string] if isinstance(string, str) else list(string) if isinstance(string, list | tuple) else [""]


def update() -> None:
    for language in LANGUAGES:
        old = catalogue(language)
        new = Catalog(
            locale=language,
            project="Spanwise",
            version="1",
            header_comment="# German texts of Spanwise's server.",
            charset="utf-8",
            fuzzy=False,
        )
        for text in sorted(server_texts(), key=str):
            singular = text if isinstance(text, str) else text[0]
            known = old.get(singular)
            is_same = known is not None and isinstance(known.id, str) == isinstance(text, str)
            new.add(text, known.string if known is not None and is_same else None)
        written = io.BytesIO()
        write_po(written, new, width=120, omit_header=False)
        kept = [
            line
            for line in written.getvalue().decode().splitlines()
            if not re.match(r'"(POT-Creation-Date|PO-Revision-Date|Last-Translator|Language-Team|Generated-By|Report-Msgid-Bugs-To):', line)
        ]
        po_file(language).write_text("\n".join(kept) + "\n")


def main(arguments: list[str]) -> int:
    if arguments == ["compile"]:
        compile_all()
        return 0
    os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
    django.setup()
    match arguments:
        case ["update"]:
            update()
        case ["missing"]:
            found = {language: [*missing_on_server(language), *missing_in_scripts(language)] for language in LANGUAGES}
            print(json.dumps(found, ensure_ascii=False, indent=1))
            return int(any(found.values()))
        case _:
            print(__doc__, file=sys.stderr)
            return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
