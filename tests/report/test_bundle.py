"""The part of Plotly that comes with the package: as it was published, and used where it is enough."""

import hashlib

from plotly.offline import get_plotlyjs

from divideropt.report.bundle import PART_DIGEST, plotly_for
from divideropt.report.page import render_report


def test_the_part_is_as_it_was_published_with_its_licence():
    part = plotly_for(["scatter", "scatter3d"])
    assert hashlib.sha256(part.encode()).hexdigest() == PART_DIGEST
    assert "Licensed under the MIT license" in part[:300]
    assert part.partition(" v")[2][:1] == get_plotlyjs().partition(" v")[2][:1], (
        "the same major version as the package"
    )


def test_what_the_part_does_not_draw_gets_all_of_it():
    assert plotly_for(["scatter", "bar"]) == get_plotlyjs()
    assert plotly_for([]) != get_plotlyjs()


def test_a_report_carries_plotly_once_and_in_part(data):
    text = render_report(data)
    assert text.count("plotly.js (gl3d - minified)") == 1
    assert "* plotly.js v" not in text
    assert plotly_for(["scatter3d"]) in text
    assert len(text) < 3e6
