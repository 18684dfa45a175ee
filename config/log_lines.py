"""What is left out of the log: links that let their holder in."""

import logging
import re

LINK = re.compile(r"(/(?:new-password|invitation)/)[^\s\"'?]+")


class WithoutLinks(logging.Filter):
    """Django names the address of each refused or failed request; of a link to an account it names only the beginning."""

    def filter(self, record: logging.LogRecord) -> bool:
        said = record.getMessage()
        shown = LINK.sub(r"\1...", said)
        if shown != said:
            record.msg, record.args = shown, ()
        return True
