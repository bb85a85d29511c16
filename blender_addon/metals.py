# SPDX-License-Identifier: GPL-3.0-or-later
"""Metals by name: complex index of refraction in red, green and blue.

The values are those of measured spectra at 611.4, 549.1 and 464.3 nm, the dominant wavelengths of
the primaries of sRGB, interpolated linearly. Spectra (refractiveindex.info, CC0):
gold, silver, copper: Johnson and Christy 1972; chromium, iron, nickel, titanium: Johnson and
Christy 1974; aluminium: Cheng et al. 2016; platinum: Rakic et al. 1998 (Lorentz-Drude);
brass (70 % Cu, 30 % Zn): Querry 1985; stainless steel (ferritic): Karlsson and Ribbing 1982.
"""

from typing import NamedTuple


class Metal(NamedTuple):
    ior: tuple
    extinction: tuple

    def reflectance(self, cosine):
        """Unpolarised Fresnel reflectance in red, green and blue, exactly."""
        return tuple(_fresnel(n, k, cosine) for n, k in zip(self.ior, self.extinction, strict=True))

    def base_color(self):
        """Reflectance seen straight on."""
        return self.reflectance(1.0)

    def edge_tint(self):
        """The tint of F82: what is left of Schlick's curve at about 82 degrees."""
        cosine = 1 / 7
        rise = (1 - cosine) ** 5
        return tuple(
            min(exact / (f0 + (1 - f0) * rise), 1.0)
            for exact, f0 in zip(self.reflectance(cosine), self.base_color(), strict=True)
        )


def _fresnel(n, k, cosine):
    sine2 = 1 - cosine * cosine
    difference = n * n - k * k - sine2
    both = (difference * difference + 4 * n * n * k * k) ** 0.5
    a = (max(both + difference, 0.0) / 2) ** 0.5
    across = (both + cosine * cosine - 2 * a * cosine) / (both + cosine * cosine + 2 * a * cosine)
    c2, s2 = cosine * cosine * both + sine2 * sine2, 2 * a * cosine * sine2
    return across * (1 + (c2 - s2) / (c2 + s2)) / 2


METALS = {
    "Aluminium": Metal((0.768, 0.588, 0.414), (5.865, 5.268, 4.438)),
    "Brass": Metal((0.452, 0.529, 0.954), (3.357, 2.756, 1.915)),
    "Chromium": Metal((3.178, 3.180, 2.450), (3.300, 3.330, 3.207)),
    "Copper": Metal((0.362, 1.015, 1.247), (3.127, 2.579, 2.453)),
    "Gold": Metal((0.222, 0.428, 1.334), (3.208, 2.461, 1.872)),
    "Iron": Metal((2.890, 2.950, 2.643), (3.040, 2.930, 2.803)),
    "Nickel": Metal((1.985, 1.920, 1.763), (3.985, 3.611, 3.043)),
    "Platinum": Metal((2.263, 2.088, 1.885), (4.060, 3.698, 3.220)),
    "Silver": Metal((0.058, 0.060, 0.047), (4.106, 3.590, 2.796)),
    "Stainless Steel": Metal((2.089, 1.901, 1.557), (3.361, 3.168, 2.835)),
    "Titanium": Metal((2.659, 2.540, 2.303), (3.698, 3.430, 3.080)),
}
