"""What is worked out for each texel of a height map, before anything is drawn."""
