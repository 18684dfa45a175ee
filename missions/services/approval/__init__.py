"""Approval of a plan: its checks, and the document that is frozen."""
