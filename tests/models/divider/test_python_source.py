"""Everything compiled against its own Python source, from parameters to verdicts."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

EVALUATE = """
import json, sys
import numpy as np
from divideropt.models.divider import Divider, Event, Scenario, load_step
formulation, designs = json.loads(sys.stdin.read())
ramp = Scenario(events=(load_step(1, 15e6, over=0.02), Event(0.6, spool_position=0.4)), end_time=1.2)
for scenario in (Scenario(), ramp):
    quantities, verdicts = Divider(formulation, scenario).evaluate(np.array(designs))
    print(json.dumps([quantities.tolist(), [[v.outcome, v.text] for v in verdicts]]))
"""


def evaluate(formulation, designs, **environment):
    run = subprocess.run(
        [sys.executable, "-c", EVALUATE],
        input=json.dumps([formulation, designs]),
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **environment},
    )
    return [json.loads(line) for line in run.stdout.splitlines()]


@pytest.mark.parametrize("formulation", ["conservative", "listing"])
def test_compiled_and_python_source_agree(design, box_designs, formulation) -> None:
    chosen = [design(), design("thesis_prototype"), design(coulomb_friction=5.0), *box_designs(5)]
    designs = [list(p.values()) for p in chosen]
    compiled, python = evaluate(formulation, designs), evaluate(formulation, designs, NUMBA_DISABLE_JIT="1")
    for (quantities, verdicts), (expected, expected_verdicts) in zip(compiled, python, strict=True):
        assert np.isfinite(quantities).any(axis=1).all()
        np.testing.assert_allclose(quantities, expected, rtol=1e-7, atol=1e-12)
        assert verdicts == expected_verdicts
