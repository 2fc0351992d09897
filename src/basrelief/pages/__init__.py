"""What all HTML pages share: the document, its style, and how a page is written."""

from basrelief.pages.page import check_ours, document, is_ours, write_page

__all__ = ["check_ours", "document", "is_ours", "write_page"]
