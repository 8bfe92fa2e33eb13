"""The divider to scale: spool in its bore, section through a groove, groove, port and fixed orifices.

Spool and bore are as `dimensions.py` arranges them, spool centred, side 1 on the left. The middle land's edges
control the ports: by (2.15) a port 1 centred d_0 within the land opens as the spool moves to the right, where (2.17)
has the load pressure act on that land's face. The grooves are a pair, φ0 each (A.1), turned so that one faces the
reader. Not of the model are the casing's outline and how far the rim stands out; the clearance is too thin to show.
"""

from divideropt.models.dimensions import (
    Form,
    Measure,
    Shape,
    Sketch,
    Step,
    View,
    circle,
    polygon,
    rectangle,
    the,
)

_WALL = 5e-3
"""Thickness of the casing as drawn [m]; the model has none."""

_ZERO = Form()

_CAPTION = (
    "To scale, from the design’s own numbers, the spool centred: lands, stems, ports, stroke and grooves are the "
    "model’s. The casing’s outer form is not in the model and only schematic, as is how far the "
    "rim stands out. The model has the total length of the lands; that the outer ones are 2h with the groove in the "
    "middle is Figure 2.4’s. Necks are r thick, as (3.22) assumes; fixed orifices are drawn as one round hole each."
)


def divider_sketch() -> Sketch:
    """Return the drawing for any design; coordinates in metres, the axis of the spool at 0."""
    return Sketch(
        (_spool(), _section(), _groove(), _port(), _orifices()),
        (
            "spool_diameter",
            "spool_length",
            "stem_diameter",
            "groove_width",
            "port_diameter",
            "port_opening",
            "stroke",
        ),
        _CAPTION,
    )


def _spool() -> View:
    radius, stem = the("spool_diameter") * 0.5, the("stem_diameter") * 0.5
    neck = radius * 0.5  # half of the radius is machined away between the lands, (3.22)
    face = the("drawn_middle_land") * 0.5  # of the middle land, from the centre
    inner = face + the("drawn_chamber")  # of an outer land
    outer = inner + the("drawn_outer_land")
    end = outer + the("drawn_stem")
    cap = outer + the("stop_position") + the("end_clearance")
    tip = cap + the("seal_length")
    rim = the("rim_thickness")
    land = ((face, -radius), (face, rim - radius), (face - rim, rim - radius), (face - rim, radius - rim),
            (face, radius - rim), (face, radius))  # fmt: skip
    middle_land = (*land, *((-x, -y) for x, y in land))
    wall = radius + _WALL
    case = ((tip, wall), (tip, stem), (cap, stem), (cap, radius))
    casing = (*case, *((-x, y) for x, y in reversed(case)))
    port, hole = the("port_diameter") * 0.5, face - the("port_offset")
    groove, width, rise = inner + the("drawn_distance"), the("groove_width") * 0.5, the("groove_rise")
    reach = outer + the("stop_position")
    middle = (inner + face) * 0.5
    behind = face - rim
    thin = (
        rectangle(outer, -stem, end, stem), rectangle(-end, -stem, -outer, stem),
        rectangle(behind, -neck, inner, neck), rectangle(-inner, -neck, -behind, neck),
    )  # fmt: skip
    outer_lands = (rectangle(inner, -radius, outer, radius), rectangle(-outer, -radius, -inner, radius))
    shapes = (
        Shape(polygon(*casing), "casing"),
        Shape(polygon(*((x, -y) for x, y in casing)), "casing"),
        Shape(rectangle(-cap, -radius, cap, radius), "oil"),
        *(Shape(outline, "steel", traced=True) for outline in thin),
        *(Shape(circle(x, _ZERO, port), "port") for x in (-hole, hole)),
        *(Shape(outline, "steel", traced=True) for outline in (polygon(*middle_land), *outer_lands)),
        *(Shape(rectangle(x - width, -rise, x + width, rise), "groove") for x in (-groove, groove)),
        *(Shape(circle(x, _ZERO, port), "edge", traced=True) for x in (-hole, hole)),
        *(Shape(polygon((x, _ZERO), (x, radius)), "hidden") for x in (-reach, reach)),
    )
    measures = (  # the longest first: labels lie over the lines before them
        Measure("spool_length", (-end, stem), (end, stem), "below", 3),
        Measure("spool_diameter", (-outer, -radius), (-outer, radius), "left"),
        Measure("stem_diameter", (end, -stem), (end, stem), "right"),
        Measure("port_opening", (-hole - port, _ZERO), (-face, -radius), "above"),
        Measure("drawn_distance", (-groove, radius), (-inner, radius), "below"),
        Measure("drawn_chamber", (face, radius), (inner, radius), "below"),
        Measure("stop_position", (outer, radius), (reach, radius), "below"),
        Measure("end_clearance", (reach, radius), (cap, radius), "below", 2),
        Measure("seal_length", (cap, stem), (tip, stem), "above"),
    )
    chamber = (radius + neck) * -0.5
    words = (
        ("Pa1", (-middle, chamber)),
        ("Pa2", (middle, chamber)),
        ("Pb1", ((outer + cap) * -0.5, chamber)),
        ("Pb2", ((outer + cap) * 0.5, chamber)),
    )
    return View("Spool in its bore", shapes, measures, words, ("radial_clearance", "rim_thickness"))


def _section() -> View:
    radius, stem = the("spool_diameter") * 0.5, the("stem_diameter") * 0.5
    rise, run = the("groove_rise"), the("groove_run")
    low, deep = rise - the("groove_depth_rise"), run - the("groove_depth_run")
    floor = radius - the("groove_depth")
    land = (
        Step((run, -rise)),
        Step((deep, -low)),
        Step((deep, low), floor),
        Step((run, rise)),
        Step((-run, rise), radius),
        Step((-deep, low)),
        Step((-deep, -low), floor),
        Step((-run, -rise)),
        Step((run, -rise), radius),
    )
    shapes = (
        Shape(circle(_ZERO, _ZERO, radius + _WALL), "casing", hole=circle(_ZERO, _ZERO, radius)),
        Shape(circle(_ZERO, _ZERO, radius), "oil"),
        Shape(land, "cut", traced=True),
        Shape(circle(_ZERO, _ZERO, stem), "hidden"),
    )
    return View("Section through a groove", shapes, notes=("groove_angle", "groove_arc"))


def _groove() -> View:
    half, depth = the("groove_width") * 0.5, the("groove_depth")
    land = polygon(
        (half * -2.0, _ZERO), (-half, _ZERO), (_ZERO, depth), (half, _ZERO), (half * 2.0, _ZERO),
        (half * 2.0, depth * 1.4), (half * -2.0, depth * 1.4),
    )  # fmt: skip
    shapes = (
        Shape(rectangle(half * -2.0, half * -0.7, half * 2.0, _ZERO), "casing"),
        Shape(polygon((-half, _ZERO), (_ZERO, depth), (half, _ZERO)), "oil"),
        Shape(land, "cut", traced=True),
    )
    measures = (
        Measure("groove_width", (-half, _ZERO), (half, _ZERO), "above"),
        Measure("groove_depth", (_ZERO, _ZERO), (_ZERO, depth), "right"),
    )
    return View("Pilot groove", shapes, measures, scale=10.0)


def _port() -> View:
    radius, edge = the("port_diameter") * 0.5, -the("port_offset")
    shapes = (
        Shape(circle(_ZERO, _ZERO, radius), "port"),
        Shape(rectangle(edge, radius * -1.15, radius * 2.15, radius * 1.15), "steel"),
        Shape(circle(_ZERO, _ZERO, radius), "edge", traced=True),
    )
    measures = (
        Measure("port_opening", (-radius, _ZERO), (edge, radius * -1.15), "above"),
        Measure("port_diameter", (-radius, _ZERO), (radius, _ZERO), "below"),
    )
    return View("Port 1 and the land’s edge, centred", shapes, measures, notes=("port_open_area",), scale=4.0)


def _orifices() -> View:
    first, second = the("fixed_orifice_diameter_1"), the("fixed_orifice_diameter_2")
    gap = 1.5e-3
    left, right = first * -0.5 - gap, second * 0.5 + gap
    shapes = tuple(
        Shape(circle(x, _ZERO, diameter * 0.5), "port", traced=True)
        for x, diameter in ((left, first), (right, second))
    )
    measures = (
        Measure("fixed_orifice_diameter_1", (left - first * 0.5, _ZERO), (left + first * 0.5, _ZERO), "below"),
        Measure("fixed_orifice_diameter_2", (right - second * 0.5, _ZERO), (right + second * 0.5, _ZERO), "below"),
    )
    return View("Fixed orifices", shapes, measures, scale=4.0)
