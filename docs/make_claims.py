"""The page `docs/model/claims.md`: every statement of the thesis that a run can show or deny, judged by runs.

Run it with `python docs/make_claims.py`; it takes some three minutes on one core.
"""

from pathlib import Path

from claims.page import write_page

PAGE = Path(__file__).parent / "model" / "claims.md"


def main() -> None:
    """Write the page."""
    PAGE.parent.mkdir(exist_ok=True)
    PAGE.write_text(write_page(), encoding="utf-8")
    print(PAGE)


if __name__ == "__main__":
    main()
