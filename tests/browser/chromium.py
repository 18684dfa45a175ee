"""Flags with which tests and benchmarks start Chromium."""

# findings: the quickest flags of those that render WebGL in Debian's Chromium without a graphics card
CHROMIUM_FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
    "--disable-sync",
]  # fmt: skip
