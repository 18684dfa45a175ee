"""supervisord for a full disk: unmodified it would exit on messages about lines that it cannot write.

python -m scripts.supervision.supervisor_program [OPTION OF supervisord]...
"""

import sys
from contextlib import suppress
from typing import Any, TextIO

from supervisor.supervisord import main


class Forgiving:
    """A stream that ignores write errors."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        with suppress(OSError):
            self._stream.write(text)
            self._stream.flush()
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


if __name__ == "__main__":
    sys.stdout, sys.stderr = Forgiving(sys.stdout), Forgiving(sys.stderr)
    main()
