"""What is optimised."""

from divideropt.models.base import Domain, Model, Outcome, Parameter, Quantity, Verdict, Verifiable

__all__ = ["Domain", "Model", "Outcome", "Parameter", "Quantity", "Verdict", "Verifiable"]
