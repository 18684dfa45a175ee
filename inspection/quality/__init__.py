"""Detection of data issues: one small detector per kind, and what each issue disconnects."""
