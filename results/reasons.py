"""The sentence of each code for why a file is not taken or not shown."""

from operation.reasons import gettext_noop, register_sentences

SENTENCES = register_sentences({
    "medium_not_decoded": gettext_noop("Stored, but files of this kind cannot be shown here."),
    "medium_undecodable": gettext_noop("The file is damaged: it cannot be decoded."),
    "medium_truncated": gettext_noop("The file is cut off: its end is missing."),
    "medium_too_many_pixels": gettext_noop("The picture has more pixels than are read here."),
    "medium_too_large_to_decode": gettext_noop("The picture is too large to be decoded in this format."),
    "medium_memory": gettext_noop("Reading the file took more memory than it may."),
    "medium_time": gettext_noop("Reading the file took longer than it may."),
    "medium_decoder_failed": gettext_noop("The decoder failed at this file."),
    "medium_missing": gettext_noop("The file is missing in the media store. Upload it again."),
})  # fmt: skip
