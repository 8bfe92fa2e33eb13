"""A toy whose quantity has the name that the share of failed samples has."""

from divideropt.models import Quantity
from toy_model import Toy


class Named(Toy):
    def __init__(self):
        super().__init__()
        self.quantities["failed_share"] = Quantity("failed_share", "%", "", "of something else", 1.0)
