# SPDX-License-Identifier: Apache-2.0
"""Cycles' time and noise with LTMD's materials against the stock anisotropic Glossy BSDF.

Run by a Python with bpy; all in one process and in turns. Times are processor seconds of one
thread between two numbers of samples, so compiling and building the scene are left out; the least
of several repeats counts. Noise is time x variance, against the sum of lobes of the same picture.
"""

import argparse
import importlib
import os
import sys
import tempfile
import time
from pathlib import Path

import bpy

bpy.utils.expose_bundled_modules()
import numpy as np  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "blender")]
from blender_process import camera, cycles, empty_scene, link, load_addon, read_image  # noqa: E402

FEW, MANY = 1, 17
# With this stretch no lobe of Tail 1.5 is rougher than closures can be.
ROUGHNESS, STRETCH = 0.4, 0.05


def scene(size):
    """A wavy sheet that fills the picture, with its rest positions, a lamp and a grey world."""
    empty_scene()
    load_addon()
    cycles(size, size)
    settings = bpy.context.scene
    settings.render.threads = 1
    settings.cycles.max_bounces = 3
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=64, y_subdivisions=64, size=4)
    obj = bpy.context.object
    positions = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", positions)
    rest = obj.data.attributes.new("ltmd_rest", "FLOAT_VECTOR", "POINT")
    rest.data.foreach_set("vector", positions)
    x, y, z = positions.reshape(-1, 3).T
    z[:] = 0.25 * np.sin(3 * x) * np.cos(2 * y)
    obj.data.vertices.foreach_set("co", positions)
    lamp = link(bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "AREA")))
    lamp.data.energy, lamp.data.size, lamp.location = 60, 1, (0.4, -1.2, 1.5)
    world = settings.world = bpy.data.worlds.new("World")
    world.use_nodes = True
    camera((0.8, 1.5, 1.4), ortho_scale=1.6)
    material = bpy.data.materials.new("Bench")
    material.use_nodes = True
    material.node_tree.nodes.clear()
    obj.data.materials.append(material)
    return material.node_tree


class Bench:
    def __init__(self, tree):
        self.tree = tree
        self.output = tree.nodes.new("ShaderNodeOutputMaterial")
        self.tangent = tree.nodes.new("ShaderNodeTangent")
        self.tangent.direction_type = "UV_MAP"

    def stock(self, lobes=((ROUGHNESS**2, 1.0),), noise=False):
        """Anisotropic Glossy BSDFs with these alphas and weights, added up by hand."""
        total = None
        for alpha, weight in lobes:
            node = self.tree.nodes.new("ShaderNodeBsdfAnisotropic")
            node.distribution = "GGX"
            node.inputs["Roughness"].default_value = alpha**0.5
            # Eq. 31's stretch: alphas (1 - s) and 1 / (1 - s) times that at rest.
            node.inputs["Anisotropy"].default_value = STRETCH
            node.inputs["Color"].default_value = (*[0.8 * weight] * 3, 1)
            self.tree.links.new(self.tangent.outputs[0], node.inputs["Tangent"])
            if noise:
                self.textured(node)
            if total is not None:
                both = self.tree.nodes.new("ShaderNodeAddShader")
                self.tree.links.new(total.outputs[0], both.inputs[0])
                self.tree.links.new(node.outputs[0], both.inputs[1])
                node = both
            total = node
        return total

    def ltmd(self, module="glossy", live=False, noise=False, **inputs):
        from blender_addon import nodes
        from blender_addon.nodes import live_tension

        node = nodes.group_node(self.tree, importlib.import_module(f"blender_addon.nodes.{module}"))
        self.tree.links.new(self.tangent.outputs[0], node.inputs["Tangent"])
        for name, value in ({"Roughness": ROUGHNESS, "Stretch": STRETCH} | inputs).items():
            node.inputs[name].default_value = value
        if live:
            uv = self.tree.nodes.new("ShaderNodeUVMap")
            source = nodes.group_node(self.tree, live_tension)
            self.tree.links.new(uv.outputs[0], source.inputs["UV"])
            for name in ("Tension", "Tangent"):
                self.tree.links.new(source.outputs[name], node.inputs[name])
        if noise:
            self.textured(node)
        return node

    def textured(self, node):
        texture = self.tree.nodes.new("ShaderNodeTexNoise")
        self.tree.links.new(texture.outputs[0], node.inputs["Roughness"])

    def use(self, node, osl):
        bpy.context.scene.cycles.shading_system = osl
        self.tree.links.new(node.outputs[0], self.output.inputs["Surface"])


def seconds(samples):
    bpy.context.scene.cycles.samples = samples
    start = time.process_time()
    bpy.ops.render.render()
    return time.process_time() - start


def picture(samples, seed):
    settings = bpy.context.scene
    settings.cycles.samples, settings.cycles.seed = samples, seed
    settings.render.image_settings.file_format = "OPEN_EXR"
    settings.render.image_settings.color_depth = "32"
    with tempfile.TemporaryDirectory() as folder:
        settings.render.filepath = os.path.join(folder, "noise.exr")
        bpy.ops.render.render(write_still=True)
        pixels = read_image(settings.render.filepath)[..., :3]
    settings.cycles.seed = 0
    return pixels


def variance(pictures=6):
    """Variance of a pixel at one sample, without the brightest hundredth of the pixels."""
    stack = np.stack([picture(8, seed) for seed in range(pictures)]).mean(axis=-1)
    per_pixel = 8 * stack.var(axis=0, ddof=1).ravel()
    return np.sort(per_pixel)[: -len(per_pixel) // 100].mean()


def first_pixel(bench, build, osl):
    """Wall seconds from adding the node to the end of a one-sample render."""
    settings = bpy.context.scene
    size = settings.render.resolution_x
    settings.render.resolution_x = settings.render.resolution_y = 8
    best = 1e9
    for _ in range(2):
        for group in list(bpy.data.node_groups):
            bpy.data.node_groups.remove(group)
        start = time.perf_counter()
        node = build()
        bench.use(node, osl)
        settings.cycles.samples = 1
        bpy.ops.render.render()
        best = min(best, time.perf_counter() - start)
    settings.render.resolution_x = settings.render.resolution_y = size
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=192, help="pixels of the picture's side")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--only", nargs="+", help="parts of the names of the variants to run")
    args = parser.parse_args()
    # Cycles talks on stdout.
    log = os.dup(1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)

    def say(text=""):
        os.write(log, (text + "\n").encode())

    bench = Bench(scene(args.size))
    import ltmd

    three = ltmd.fit_lobes(ROUGHNESS**2, 1.5, 3)
    by_hand = list(zip(three.alpha, three.weight, strict=True))
    # name: (build, OSL, the variant of the same picture whose noise is 1)
    variants = {
        "stock Glossy": (bench.stock, False, None),
        "stock Glossy, OSL": (bench.stock, True, None),
        "LTMD 1 lobe": (bench.ltmd, True, None),
        "LTMD 3 lobes": (lambda: bench.ltmd(Tail=1.5), True, "LTMD 3 lobes"),
        "LTMD 5 lobes": (lambda: bench.ltmd(Tail=1.5, Lobes=5), True, "LTMD 5 lobes"),
        "LTMD 3, beyond alpha 1": (lambda: bench.ltmd(Tail=1.5, Stretch=0.4), True, None),
        "LTMD 5 lobes, Tail 3": (lambda: bench.ltmd(Tail=3.0), True, "LTMD 5 lobes, Tail 3"),
        "roulette of 3": (lambda: bench.ltmd(Tail=1.5, Mode=1), True, "LTMD 3 lobes"),
        "roulette of 5": (lambda: bench.ltmd(Tail=1.5, Lobes=5, Mode=1), True, "LTMD 5 lobes"),
        "3 stock Glossy by hand": (lambda: bench.stock(by_hand), False, "LTMD 3 lobes"),
        "3 stock by hand, OSL": (lambda: bench.stock(by_hand), True, "LTMD 3 lobes"),
        "LTMD 1 lobe, live": (lambda: bench.ltmd(live=True), True, None),
        "LTMD 3 lobes, live": (lambda: bench.ltmd(live=True, Tail=1.5), True, None),
        "stock, textured, OSL": (lambda: bench.stock(noise=True), True, None),
        "LTMD 1 lobe, textured": (lambda: bench.ltmd(noise=True), True, None),
        "LTMD 3 lobes, textured": (lambda: bench.ltmd(noise=True, Tail=1.5), True, None),
    }
    if importlib.util.find_spec("blender_addon.nodes.glossy_no_osl"):
        variants |= {
            "no OSL, 1 lobe": (lambda: bench.ltmd("glossy_no_osl"), False, None),
            "no OSL, 3 lobes": (
                lambda: bench.ltmd("glossy_no_osl", Tail=1.5),
                False,
                "LTMD 3 lobes",
            ),
        }
    if args.only:
        variants = {
            name: variant
            for name, variant in variants.items()
            if name.startswith("stock Glossy") or any(part in name for part in args.only)
        }
    first = {name: first_pixel(bench, build, osl) for name, (build, osl, _) in variants.items()}
    nodes = {name: build() for name, (build, _, _) in variants.items()}
    times = {name: [] for name in variants}
    for _ in range(args.repeats):
        for name, (_, osl, _) in variants.items():
            bench.use(nodes[name], osl)
            times[name].append((seconds(FEW), seconds(MANY)))
    cost = {
        name: min(many for _, many in pairs) - min(few for few, _ in pairs)
        for name, pairs in times.items()
    }
    noise = {}
    for name, (_, osl, same) in variants.items():
        if same:
            bench.use(nodes[name], osl)
            noise[name] = variance()
    # A sum that was left out by --only gives no comparison.
    noise = {name: v for name, v in noise.items() if variants[name][2] in noise}
    say(f"Blender {bpy.app.version_string}, {args.size} x {args.size}, {args.repeats} repeats")
    say(f"{'':24}  time / stock  / stock OSL  time x variance  first pixel")
    for name, (_, _, same) in variants.items():
        equal = ""
        if name in noise:
            equal = f"{cost[name] * noise[name] / (cost[same] * noise[same]):.2f}"
        say(
            f"{name:24} {cost[name] / cost['stock Glossy']:13.2f} "
            f"{cost[name] / cost['stock Glossy, OSL']:12.2f} {equal:>16} {first[name]:10.2f} s"
        )
    os._exit(0)


if __name__ == "__main__":
    main()
