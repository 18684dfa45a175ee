"""Author names of changes to shared map data: shown within the same organisation only."""

from django.utils.translation import gettext as _

from workspace.models import User

AUTHOR_HELP = 'a name, or "another organisation" in your language'


def author_name(author: User | None, reader: User) -> str | None:
    """Return the author's name as `reader` may know it: installation operators see all. None where there is no author."""
    if author is None:
        return None
    is_known = reader.operates_installation or author.organisation_id == reader.organisation_id
    return author.display_name if is_known else _("another organisation")
