"""Number of features of each letter in docs/contributing/features.md."""

COUNTS = {"C": 21, "W": 10, "G": 12, "H": 9, "L": 8, "B": 22}
