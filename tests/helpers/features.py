"""The features that docs/contributing/features.md lists: how many rows under each letter."""

COUNTS = {"C": 21, "W": 10, "G": 12, "H": 9, "L": 8, "B": 14}
