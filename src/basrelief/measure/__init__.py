"""Errors and costs of techniques: the exact hits in float64, and errors against them."""
