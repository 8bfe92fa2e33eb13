"""The pages `docs/model/claims.md`, every statement of the thesis that a run can show or deny, and `claims_cases.md`.

Run it with `python docs/make_claims.py`; it takes some two or three minutes on one core.
"""

from pathlib import Path

from claims.page import write_pages

PAGES = Path(__file__).parent / "model"


def main() -> None:
    """Write the pages."""
    PAGES.mkdir(exist_ok=True)
    for name, text in write_pages().items():
        (PAGES / name).write_text(text, encoding="utf-8")
        print(PAGES / name)


if __name__ == "__main__":
    main()
