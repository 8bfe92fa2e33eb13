"""The thesis's statements, judged by runs of our own: what `docs/make_claims.py` writes as a page."""
