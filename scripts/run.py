"""./run: checks its options, sets the checkout up, and executes scripts.start in .venv. Needs only Python.

python -m scripts.run [OPTION]...
"""

import os
import subprocess
import sys
from pathlib import Path

from scripts.options import parse, port_problem

PROJECT_DIR = Path(__file__).resolve().parent.parent
PYTHON = PROJECT_DIR / ".venv" / "bin" / "python"


def set_up(arguments: list[str]) -> int:
    """Check the options, then install what is missing. Returns the exit code to end with, 0 to continue."""
    options = parse(arguments, PROJECT_DIR)
    os.environ["SPANWISE_VAR"] = str(options.var)
    is_start = not (options.status or options.stop)
    if not is_start and PYTHON.exists():  # stopping needs nothing new, and must not wait for a compiler
        return 0
    # A running installation may use the port itself; scripts.start checks that.
    if is_start and not (options.var / "instance.json").exists() and (problem := port_problem(options.port)):
        print(problem, file=sys.stderr)
        return 1
    return subprocess.run([str(PROJECT_DIR / "scripts" / "setup"), "run"], check=False).returncode


if __name__ == "__main__":
    try:
        if code := set_up(sys.argv[1:]):
            sys.exit(code)
    except KeyboardInterrupt:
        sys.exit(130)
    os.execv(PYTHON, [str(PYTHON), "-m", "scripts.start", *sys.argv[1:]])  # noqa: S606 - no shell
