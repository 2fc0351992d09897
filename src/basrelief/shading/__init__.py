"""The pixel shader and its parts: from the primary ray to the colour. Start with `pixel.py`."""
