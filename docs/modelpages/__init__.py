"""What `docs/make_model_pages.py` writes into the pages of `docs/model/`, from the model's own runs."""
