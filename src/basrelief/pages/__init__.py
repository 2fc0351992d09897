"""The shared parts of all HTML pages: templates, style, policy, and how a page is written."""

from basrelief.pages.page import check_ours, is_ours, write_page
from basrelief.pages.template import fill

__all__ = ["check_ours", "fill", "is_ours", "write_page"]
