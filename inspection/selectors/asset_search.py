"""In which order assets answer to a text: what is called exactly so first, whole lines before their supports."""

from django.db.models import Case, IntegerField, Q, QuerySet, Value, When

from inspection.models import AssetKind
from inspection.selectors.assets import DrawnAsset

BEST_FIRST = ("match_rank", "pk")


def with_match_rank(assets: QuerySet[DrawnAsset], *, text: str) -> QuerySet[DrawnAsset]:
    """The same assets with `match_rank`: 0 and 1 are called exactly `text`, 2 and 3 otherwise found; supports have the odd ranks."""
    is_exact = Q(ref__iexact=text) | Q(name__iexact=text)
    is_support = Q(kind=AssetKind.TOWER)
    rank = Case(
        When(is_exact & ~is_support, then=Value(0)),
        When(is_exact, then=Value(1)),
        When(~is_support, then=Value(2)),
        default=Value(3),
        output_field=IntegerField(),
    )
    return assets.annotate(match_rank=rank)
