"""From a scene to its picture: textures, programs, shadow maps, frames, films."""
