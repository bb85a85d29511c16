# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of single frames as USD files, the tension on their corners as a primvar.

Blender's exporter would need the attribute on meshes of the file, which must not change during a
bake; its own USD library writes what is evaluated.
"""

import contextlib
import os
import secrets

import bpy
import numpy as np

PRIMVAR = "ltmd_tension"
# As Blender writes them.
UP, METRES = "Z", 1.0


def problem():
    """None if USD files can be written, else a sentence."""
    try:
        _pxr()
    except ImportError as error:
        return f"This Blender has no USD library for Python ({error})"
    return None


def _pxr():
    bpy.utils.expose_bundled_modules()
    import pxr.Gf
    import pxr.Sdf
    import pxr.Tf
    import pxr.Usd
    import pxr.UsdGeom
    import pxr.Vt

    return pxr


def write(path, name, points, matrix, face_sizes, corner_vert, uv, tension, metadata):
    """One mesh, in its own space under its matrix; the file appears when it is complete.

    uv and tension are per corner (faceVarying primvars st and ltmd_tension). Raises OSError.
    """
    pxr = _pxr()
    sdf, vt, geom = pxr.Sdf, pxr.Vt, pxr.UsdGeom
    # Not tempfile: its files are for one user alone.
    temporary = os.path.join(os.path.dirname(path), f".ltmd-{secrets.token_hex(8)}.usdc")
    try:
        stage = pxr.Usd.Stage.CreateInMemory()
        geom.SetStageUpAxis(stage, UP)
        geom.SetStageMetersPerUnit(stage, METRES)
        stage.GetRootLayer().customLayerData = dict(metadata)
        root = geom.Xform.Define(stage, "/" + pxr.Tf.MakeValidIdentifier(name))
        # USD's matrices act on rows.
        root.AddTransformOp().Set(pxr.Gf.Matrix4d(np.array(matrix, float).T.tolist()))
        stage.SetDefaultPrim(root.GetPrim())
        mesh = geom.Mesh.Define(stage, root.GetPath().AppendChild("Mesh"))
        mesh.CreateSubdivisionSchemeAttr(geom.Tokens.none)
        mesh.CreatePointsAttr(vt.Vec3fArray.FromNumpy(points))
        mesh.CreateFaceVertexCountsAttr(vt.IntArray.FromNumpy(face_sizes))
        mesh.CreateFaceVertexIndicesAttr(vt.IntArray.FromNumpy(corner_vert))
        mesh.CreateExtentAttr(geom.PointBased.ComputeExtent(vt.Vec3fArray.FromNumpy(points)))
        primvars = geom.PrimvarsAPI(mesh)
        for key, kind, values in (
            ("st", sdf.ValueTypeNames.TexCoord2fArray, vt.Vec2fArray.FromNumpy(uv)),
            (PRIMVAR, sdf.ValueTypeNames.Float3Array, vt.Vec3fArray.FromNumpy(tension)),
        ):
            primvars.CreatePrimvar(key, kind, geom.Tokens.faceVarying).Set(values)
        try:
            done = stage.GetRootLayer().Export(temporary)
        except pxr.Tf.ErrorException as error:
            raise OSError(f"{path}: could not be written ({error})") from None
        if not done:
            raise OSError(f"{path}: could not be written")
        os.replace(temporary, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.remove(temporary)
        raise


def metadata(path):
    """What write() was given, or None for a file that cannot be read."""
    pxr = _pxr()
    try:
        layer = pxr.Sdf.Layer.OpenAsAnonymous(path)
    except pxr.Tf.ErrorException:
        return None
    return dict(layer.customLayerData) if layer else None


def read_face_sizes(mesh):
    sizes = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("loop_total", sizes)
    return sizes
