"""One pixel, from its ray to its colour. Read `pixel.py` first; it reads from top to bottom."""
