"""Texts of the reason codes of imports: progress, refusals, and why one waits for review."""

from collections.abc import Iterable
from typing import Any

from operation.reasons import Reason, gettext_noop, register_sentences

SENTENCES = register_sentences({
    # progress
    "waiting_to_be_read": gettext_noop("Waiting to be read"),
    "waiting_to_be_applied": gettext_noop("Waiting to be applied"),
    "waiting_to_be_fetched": gettext_noop("Waiting to be fetched"),
    "waiting_to_be_deleted": gettext_noop("Waiting to be deleted"),
    "deleting_zones": gettext_noop("deleting the zones"),
    "deleting_terrain": gettext_noop("deleting the terrain"),
    "deleting_assets": gettext_noop("deleting the assets"),
    "deleting_rest": gettext_noop("finishing"),
    "region_deleted": gettext_noop("Deleted"),
    "waiting_to_be_written": gettext_noop("Waiting to be written"),
    "file_written": gettext_noop("Written"),
    "file_read": gettext_noop("Read"),
    "file_refused": gettext_noop("Refused"),
    "file_applied": gettext_noop("Applied"),
    "file_held_back": gettext_noop("Held back: look at the difference."),
    "ground_has_changed": gettext_noop("The ground has changed since: look at the difference again."),
    "writing": gettext_noop("writing"),
    "comparing": gettext_noop("comparing"),
    "comparing_rows": gettext_noop("comparing, row %(row)s"),
    "comparing_answer": gettext_noop("Comparing"),
    "fetching": gettext_noop("Fetching"),
    "asking_overpass": gettext_noop("asking Overpass"),
    "size_from_overpass": gettext_noop("%(size)s MiB from Overpass"),
    "overpass_busy": gettext_noop("Overpass is busy; next try in %(seconds)s s"),
    "writing_heights": gettext_noop("writing the heights"),
    "reading_heights": gettext_noop("reading the heights"),
    "reading_rows": gettext_noop("reading the rows"),
    "reading_rows_row": gettext_noop("reading the rows, row %(row)s"),
    "writing_assets": gettext_noop("writing the assets"),
    "reading_zones": gettext_noop("reading the zones"),
    "writing_zones": gettext_noop("writing the zones"),
    "reading_relations": gettext_noop("relations"),
    "reading_ways": gettext_noop("ways"),
    "reading_way_nodes": gettext_noop("way nodes"),
    "reading_towers": gettext_noop("towers and poles"),
    "making_geometry": gettext_noop("geometry"),
    "osm_read": gettext_noop("read"),
    "looking_file_over": gettext_noop("looking the file over, %(size)s MiB"),
    # subscriptions
    "subscription_gone": gettext_noop("The subscription is no longer there."),
    "subscription_changed": gettext_noop("The subscription was changed meanwhile."),
    "new_file_proposed": gettext_noop("A new file is proposed."),
    "nothing_new": gettext_noop("Nothing new."),
    # why it waits for review
    "columns_not_explained": gettext_noop("The columns of the file are not explained yet."),
    "records_left_out": gettext_noop("Records of the file that have a fault and are left out: %(number)s."),
    "values_unread": gettext_noop("Values of the file that cannot be read and would be empty: %(number)s."),
    "removes_too_many": gettext_noop(
        "It removes %(removed)s of %(known)s rows of its source, %(percent)s %%; at most %(limit)s %% may be removed."
    ),
    # failures
    "not_read_in_time": gettext_noop("Not done within %(minutes)s min. Cut the file into parts."),
    "too_much_processor_time": gettext_noop("Reading the file takes more processor time than a file of its size may need."),
    "too_much_memory": gettext_noop("The file needs more memory than there is. Cut it into parts."),
    "reading_failed": gettext_noop("Reading the file failed inside Spanwise; the error is in the log."),
    # faults of a file
    "no_file": gettext_noop("There is no file."),
    "file_not_kept": gettext_noop("The file is no longer kept. Send it again."),
    "file_not_read": gettext_noop("The file could not be read."),
    "other_format": gettext_noop("This is a %(format)s file, which holds none of the data that Spanwise reads."),
    "no_records": gettext_noop("The file has no records: it is an empty collection."),
    "import_without_history": gettext_noop("An earlier version applied this import without noting what it changed: it cannot be undone."),
    "import_gone": gettext_noop("The import that was to be undone is no longer known."),
    "file_empty": gettext_noop("The file is empty."),
    "file_unreadable": gettext_noop("The file cannot be read: %(error)s"),
    "no_osm_format": gettext_noop("This is neither OSM XML, OSM PBF nor Overpass JSON."),
    "pbf_damaged": gettext_noop("The PBF is cut off or damaged at byte %(byte)s."),
    "no_infrastructure": gettext_noop("The file has no power lines, towers, railways or bridges."),
    "overpass_incomplete": gettext_noop("Overpass did not give all of it: %(fault)s. Take a smaller area."),
    "no_terrain_format": gettext_noop("This is neither a GeoTIFF nor an HGT file, zipped or not."),
    "no_json": gettext_noop("This is no JSON: %(error)s"),
    "no_utf8": gettext_noop("The text is not UTF-8: byte %(byte)s cannot be read."),
    "reader_ended": gettext_noop("The file is damaged, or reading it needs more than %(mib)s MiB of memory."),
    "reader_memory": gettext_noop("Reading the file needs more than %(mib)s MiB of memory. Cut it into parts."),
    "reader_time": gettext_noop("Reading the file takes longer than %(seconds)s s. Cut it into parts."),
    "leads_elsewhere": gettext_noop("This is a %(format)s file: it leads to other files or servers. Send the data themselves."),
    # notes for users
    "minutes_of_60": gettext_noop("Minutes or seconds of 60 were read as the next degree or minute: %(places)s."),
    "voids": gettext_noop(
        "%(voids)s of %(posts)s posts are void (%(percent)s %%). "
        "An older model fills them where it reaches; elsewhere the ground stays unknown. Nothing is made up."
    ),
    "undeclared_voids": gettext_noop(
        "%(voids)s of %(posts)s posts are void (%(percent)s %%), %(undeclared)s of them without being declared. "
        "An older model fills them where it reaches; elsewhere the ground stays unknown. Nothing is made up."
    ),
})  # fmt: skip


def notes_json(notes: Iterable[str | Reason]) -> dict[str, list[Any]]:
    """Return notes in English with the reason of each; None for a note that is only a text."""
    listed = list(notes)
    return {"notes": [str(note) for note in listed], "notes_why": [note.to_json() if isinstance(note, Reason) else None for note in listed]}
