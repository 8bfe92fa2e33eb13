"""What is optimised."""

from divideropt.models.base import Domain, Model, Outcome, Parameter, Quantity, Verdict

__all__ = ["Domain", "Model", "Outcome", "Parameter", "Quantity", "Verdict"]
