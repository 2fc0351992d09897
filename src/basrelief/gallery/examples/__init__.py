"""The pages of the gallery, one file each."""
