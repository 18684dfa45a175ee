"""Models of media and findings."""

from results.models.findings import Evidence, Finding, FindingComment, Observation, ObservationOutcome, SeveritySource
from results.models.media import MediaUpload, Medium, MediumKind, MediumState, Placement, Review, TakenAtSource

__all__ = [
    "Evidence",
    "Finding",
    "FindingComment",
    "MediaUpload",
    "Medium",
    "MediumKind",
    "MediumState",
    "Observation",
    "ObservationOutcome",
    "Placement",
    "Review",
    "SeveritySource",
    "TakenAtSource",
]
