"""What a surface is made of where the ray ends, read from the material's maps."""
