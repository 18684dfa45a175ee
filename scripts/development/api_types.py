"""The TypeScript types of the API's shapes, static/js/api_types.d.ts, made from the OpenAPI document.

python -m scripts.development.api_types [--check]      (--check only reports whether the file is current)
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

PROJECT_DIR = Path(__file__).resolve().parents[2]
TYPES = PROJECT_DIR / "static" / "js" / "api_types.d.ts"
GENERATOR = PROJECT_DIR / "node_modules" / "openapi-typescript" / "bin" / "cli.js"
NODE = Path(sys.executable).with_name("node")
HEADER = "// Made by `python -m scripts.development.api_types` from the OpenAPI document: change the serializers, then run it again.\n\n"


def _output(*command: str) -> str:
    return subprocess.run(command, cwd=PROJECT_DIR, check=True, capture_output=True, text=True).stdout


def openapi_schemas() -> dict[str, object]:
    """Return the OpenAPI document reduced to its named schemas: scripts of pages name shapes, not operations."""
    document = json.loads(_output(sys.executable, "manage.py", "spectacular", "--format", "openapi-json"))
    return {
        "openapi": document["openapi"],
        "info": {"title": "Spanwise", "version": "1"},
        "paths": {},
        "components": {"schemas": document["components"]["schemas"]},
    }


def generated_types() -> str:
    """Return the content of the file. Raises CalledProcessError with the generator's output."""
    with tempfile.TemporaryDirectory() as folder:
        document, types = Path(folder) / "openapi.json", Path(folder) / "types.d.ts"
        document.write_text(json.dumps(openapi_schemas()))
        _output(str(NODE), str(GENERATOR), str(document), "--output", str(types), "--root-types", "--root-types-no-schema-prefix")
        return HEADER + types.read_text()


def main(arguments: list[str]) -> int:
    try:
        content = generated_types()
    except subprocess.CalledProcessError as error:
        print(error.stdout, error.stderr, sep="\n", file=sys.stderr)
        return 1
    if "--check" not in arguments:
        TYPES.write_text(content)
        return 0
    if TYPES.exists() and TYPES.read_text() == content:
        return 0
    print(
        f"{TYPES.relative_to(PROJECT_DIR)} is not what the OpenAPI document says: run python -m scripts.development.api_types",
        file=sys.stderr,
    )
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
