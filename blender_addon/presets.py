# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials by name: the papers' own, practical ones, and metals.

Values are those of sockets; a paper's alpha is Roughness squared. Its "stretch by a factor f" along
U is, by equation 31 of microsurface-transformations, f = 1 / (1 - s): Stretch s = 1 - 1 / f.
"""

from math import pi
from typing import NamedTuple

from .metals import METALS
from .nodes import conductor, dielectric, glossy


class Preset(NamedTuple):
    label: str
    group: object  # module of the node group
    sockets: dict  # name -> value
    source: str  # where the values are from
    base: tuple | None = None  # colour under the coat or reflection; None: stays as it is


def _roughness(alpha):
    return alpha**0.5


def _stretch(factor):
    return 1 - 1 / factor


def _metal(name):
    """The metal in both ways a conductor takes it."""
    metal = METALS[name]
    return {
        "Conductor Type": 1,
        "IOR": metal.ior,
        "Extinction": metal.extinction,
        "Base Color": (*metal.base_color(), 1.0),
        "Edge Tint": (*metal.edge_tint(), 1.0),
    }


_REST = {
    "Roughness Is Alpha": False,
    "Tail": 2.0,
    "Stretch": 0.0,
    "Rotation": 0.0,
    "Shear": 0.0,
    "Height Response": 0.0,
}
_COAT = {"Coat Tint": (1.0, 1.0, 1.0, 1.0), "IOR": 1.5}
_PAPER = "microsurface-transformations"


def _coat(label, roughness, source, base=None, **sockets):
    names = {name.replace("_", " "): value for name, value in sockets.items()}
    return Preset(label, dielectric, _REST | _COAT | {"Roughness": roughness} | names, source, base)


def _conductor(label, metal, roughness, source, **sockets):
    return Preset(
        label, conductor, _REST | _metal(metal) | {"Roughness": roughness} | sockets, source
    )


def _vase(alpha, tail):
    return _conductor(
        f"Vase {alpha:g}, Tail {tail:g}",
        "Aluminium",
        _roughness(alpha),
        f"{_PAPER}, Fig. 8: alpha {alpha:g}, gamma {tail:g}, stretch 5/2",
        Tail=tail,
        Stretch=_stretch(5 / 2),
    )


# Where a colour is given, it is linear.
PRACTICAL = {
    "RUBBER_BALLOON": _coat(
        "Rubber Balloon",
        0.45,
        "Matte while limp, glossy when blown up: the bumps keep their volume",
        (0.42, 0.006, 0.01, 1.0),
        IOR=1.52,
        Tail=1.7,
        Height_Response=1.0,
    ),
    "LATEX": _coat(
        "Latex",
        0.24,
        "Polished rubber: a sharp highlight in a wide faint halo",
        (0.008, 0.008, 0.01, 1.0),
        IOR=1.52,
        Tail=1.4,
    ),
    "BRUSHED_ALUMINIUM": _conductor(
        "Brushed Aluminium",
        "Aluminium",
        0.36,
        "Brushed along U; measured metal",
        Tail=1.6,
        Stretch=0.55,
    ),
    "BRUSHED_GOLD": _conductor(
        "Brushed Gold",
        "Gold",
        0.32,
        "Brushed along U; measured metal",
        Tail=1.6,
        Stretch=0.5,
    ),
    "SATIN_RIBBON": _coat(
        "Satin Ribbon",
        0.5,
        "Threads along V: the highlight lies across them",
        (0.16, 0.006, 0.05, 1.0),
        Coat_Tint=(1.0, 0.55, 0.68, 1.0),
        IOR=2.4,
        Tail=1.8,
        Stretch=0.6,
        Rotation=pi / 2,
    ),
    "SKIN_SHEEN": _coat(
        "Skin Sheen",
        0.46,
        "Oily skin: shinier where it is stretched",
        (0.42, 0.19, 0.12, 1.0),
        IOR=1.45,
        Tail=1.6,
        Height_Response=0.5,
    ),
    "CAR_PAINT": _coat(
        "Car Paint Coat",
        0.14,
        "Clear varnish over paint, with the haze of fine scratches",
        (0.008, 0.035, 0.21, 1.0),
        IOR=1.55,
        Tail=1.1,
    ),
}

PAPERS = {
    "BIRD": _coat(
        "Bird: Elastic", _roughness(0.25), f"{_PAPER}, Fig. 6: alpha 0.25, gamma 2.2", Tail=2.2
    ),
    "DOG": _coat(
        "Dog: Elastic", _roughness(0.16), f"{_PAPER}, Fig. 6: alpha 0.16, gamma 1.4", Tail=1.4
    ),
    "SILVER_PLATE": _conductor(
        "Silver Plate",
        "Silver",
        _roughness(0.0121),
        f"{_PAPER}, Fig. 1: alpha 0.0121, gamma 1.7",
        Tail=1.7,
    ),
    "SILVER_PLATE_STRETCHED": _conductor(
        "Silver Plate, Stretched",
        "Silver",
        _roughness(0.0121),
        f"{_PAPER}, Fig. 1: alpha 0.0121, gamma 1.7, stretch 5",
        Tail=1.7,
        Stretch=_stretch(5),
    ),
    **{
        f"VASE_{round(1000 * alpha)}_{round(10 * tail)}": _vase(alpha, tail)
        for tail in (1.0, 3.5)
        for alpha in (0.01, 0.04, 0.16)
    },
    "TORUS_KNOT": Preset(
        "Torus Knot",
        glossy,
        _REST
        | {
            "Color": (1.0, 1.0, 1.0, 1.0),
            "Roughness": _roughness(0.3),
            "Tail": 1.0,
            "Stretch": 0.75,
        },
        f"{_PAPER}, Fig. 10: alpha 0.3, gamma 1, s 0.75",
    ),
}

METAL = {
    name.upper().replace(" ", "_"): Preset(
        name, conductor, _metal(name), "Measured index of refraction; the highlight's shape stays"
    )
    for name in METALS
}

GROUPS = (("Materials", PRACTICAL), ("Metals", METAL), ("From the Papers", PAPERS))
PRESETS = {key: preset for _heading, part in GROUPS for key, preset in part.items()}


def items():
    """For an EnumProperty: under headings."""
    found = []
    for heading, part in GROUPS:
        found.append(("", heading, ""))
        found += [(key, preset.label, preset.source) for key, preset in part.items()]
    return found
