"""Printers of the typed tree as text: a C-like base, and a child for each language."""
