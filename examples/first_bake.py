# SPDX-License-Identifier: Apache-2.0
import ltmd
import numpy as np

uv = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32)
triangles = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
mesh = ltmd.Mesh(triangles, np.arange(4, dtype=np.int32), uv, vertex_count=4)
rest = np.pad(uv, [(0, 0), (0, 1)])  # a unit square in the plane z = 0
deformed = rest * np.float32([2, 0.5, 1])  # twice as wide, half as high

t = ltmd.tension(mesh, rest, deformed)  # per corner (t11, t12, t22)
print("stretch along u, shear, stretch along v:", t[0])
pixels = ltmd.bake(mesh, t, width=256, height=256)
ltmd.write_exr("square_tension.0001.exr", pixels, metadata={"ltmd:convention": 1})
