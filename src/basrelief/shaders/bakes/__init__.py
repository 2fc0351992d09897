"""What is worked out from a height map once: an entry for each step, one invocation a texel."""
