"""Models of media and findings."""

from results.models.media import MediaUpload, Medium, MediumKind, MediumState, Placement, Review, TakenAtSource

__all__ = ["MediaUpload", "Medium", "MediumKind", "MediumState", "Placement", "Review", "TakenAtSource"]
