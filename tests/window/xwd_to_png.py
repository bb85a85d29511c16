# SPDX-License-Identifier: Apache-2.0
"""xwd_to_png.py IN.xwd OUT.png: a dump of an X screen (32 bits a pixel) as a PNG."""

import struct
import sys

import numpy as np
import OpenImageIO as oiio

data = open(sys.argv[1], "rb").read()
header = struct.unpack(">25I", data[:100])
size, width, height, bits, line, colours = (header[i] for i in (0, 4, 5, 11, 12, 19))
assert header[1] == 7 and bits == 32 and header[7] == 0, "not a dump this script knows"
start = size + 12 * colours
rows = np.frombuffer(data, np.uint8, height * line, start).reshape(height, line)
pixels = rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1]
image = oiio.ImageBuf(oiio.ImageSpec(width, height, 3, "uint8"))
image.set_pixels(oiio.ROI(0, width, 0, height), np.ascontiguousarray(pixels))
assert image.write(sys.argv[2]), oiio.geterror()
