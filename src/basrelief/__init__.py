"""basrelief: parallax mapping, written once in Python."""
