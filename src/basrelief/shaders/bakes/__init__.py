"""What is worked out from the heights before anything is drawn, texel by texel, as shaders."""
