"""Compile the planners' core at set-up, so that no request waits for it; does nothing where nothing has changed.

python -m scripts.compile_core [--check]      (--check only says, by its exit code, whether there is nothing to do)
"""

import shutil
import sys

from config.compiled_core import STAMP, compiled_directory, compiled_stamp, is_compiled
from scripts.telling import step


def main() -> int:
    folder = compiled_directory()
    if is_compiled(folder):
        return 0
    if "--check" in sys.argv[1:]:
        return 1
    shutil.rmtree(folder.parent, ignore_errors=True)  # with what was compiled from older sources
    folder.mkdir(parents=True)
    # Only now: numba reads where to keep things as it is imported.
    from inspection.graph import rehearsal as of_the_graph  # noqa: PLC0415
    from missions.flight_plan import rehearsal as of_the_drawing  # noqa: PLC0415
    from missions.routing import file_plans  # noqa: PLC0415
    from missions.routing import rehearsal as of_the_solvers  # noqa: PLC0415

    parts = {
        "graph": of_the_graph.rehearse,
        "assignment": of_the_solvers.rehearse,
        "heights, time and energy": of_the_drawing.rehearse,
        "plans of files": file_plans.rehearse,
    }
    for number, (name, rehearse) in enumerate(parts.items(), start=1):
        with step(f"The planners' core, compiled: {name} ({number} of {len(parts)})"):
            rehearse()
    (folder / STAMP).write_text(compiled_stamp())
    return 0


if __name__ == "__main__":
    sys.exit(main())
