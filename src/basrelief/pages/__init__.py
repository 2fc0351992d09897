"""Shared parts of all HTML pages: templates, style, content policy, and the writing of files."""

from basrelief.pages.page import check_overwritable, is_generated_by, write_page
from basrelief.pages.template import fill

__all__ = ["check_overwritable", "fill", "is_generated_by", "write_page"]
