# SPDX-License-Identifier: Apache-2.0
"""Baked tension is read as data whatever the studio calls its colour spaces."""

import numpy as np
import pytest
from blender_process import run
from test_setup import PRELUDE

CONFIG = """ocio_profile_version: 1
search_path: ""
strictparsing: true
luma: [0.2126, 0.7152, 0.0722]
roles:
  reference: {linear}
  scene_linear: {linear}
  rendering: {linear}
  default: {linear}
  color_picking: {display}
  texture_paint: {display}
  data: {data}
displays:
  Monitor:
    - !<View> {{name: Film, colorspace: {display}}}
active_displays: [Monitor]
active_views: [Film]
colorspaces:
  - !<ColorSpace>
    name: {linear}
    isdata: false
  - !<ColorSpace>
    name: {display}
    isdata: false
    from_reference: !<ExponentTransform> {{value: [0.45, 0.45, 0.45, 1]}}
  - !<ColorSpace>
    name: {data}
    isdata: true
"""
# Neither knows "Non-Color" or "sRGB".
NAMES = {
    "aces": {"linear": "ACEScg", "display": "Output - Rec.709", "data": "Raw"},
    "vfx": {"linear": "lin_rec709", "display": "Gamma 2.2", "data": "Utility - Raw"},
}


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_tension_is_read_raw_under_other_colour_configs(tmp_path, names):
    config = tmp_path / "config.ocio"
    config.write_text(CONFIG.format(**names))
    result = run(
        PRELUDE
        + """
scene = cycles(4, 4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                  [(0, 0), (1, 0), (1, 1), (0, 1)])
camera((0, 0, 3), ortho_scale=.5)
material = new_material("M", obj)
pixels = np.ones((8, 8, 4), np.float32)
pixels[..., :3] = (1.5, -0.25, 0.125)
path = os.path.join(ARGUMENTS, "Plane_tension.0001.exr")
write_image(path, pixels)
bpy.ops.ltmd.setup(object_name="Plane")
source.switch_to_texture(obj, material, {1001: {"path": path, "frames": [1]}})
tree = material.node_tree
socket = surface.lobe(material).inputs["Tension"].links[0].from_socket
emission = tree.nodes.new("ShaderNodeEmission")
tree.links.new(socket, emission.inputs["Color"])
tree.links.new(emission.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
image = next(n for n in tree.nodes if n.type == "TEX_IMAGE").image
report(seen=render(1)[2, 2, :3], space=image.colorspace_settings.name)
""",
        arguments=str(tmp_path),
        environment={"OCIO": str(config)},
    )
    assert result["space"] == names["data"]
    assert np.abs(np.array(result["seen"]) - (1.5, -0.25, 0.125)).max() < 1e-5
