"""Approval of a plan: its checks, and the frozen document."""
