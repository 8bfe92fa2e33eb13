"""What `docs/model/figures.md` is made of: every figure of Chapters 2 and 3 that a program can draw."""
