# SPDX-License-Identifier: GPL-3.0-or-later
"""Arithmetic in shader trees: a Scalar or a Vector is a socket (or numbers) that operators and
functions turn into Math and Vector Math nodes."""

COLUMN = 160  # from one node to the next, in the editor
ROW = 180


class _Value:
    def __init__(self, tree, value):
        self.tree = tree
        self.value = value.value if isinstance(value, _Value) else value

    def feed(self, socket):
        """Give the value to an input: a link, or the numbers typed in."""
        if hasattr(self.value, "is_output"):
            self.tree.links.new(self.value, socket)
        else:
            socket.default_value = self.value

    def _node(self, kind, operation, values):
        node = self.tree.nodes.new(kind)
        node.operation = operation
        for socket, value in zip(node.inputs, values, strict=False):
            type(self)(self.tree, value).feed(socket)
        return node


class Scalar(_Value):
    def _math(self, operation, *values):
        return Scalar(self.tree, self._node("ShaderNodeMath", operation, values).outputs[0])

    def __add__(self, other):
        return self._math("ADD", self, other)

    def __radd__(self, other):
        return self._math("ADD", other, self)

    def __sub__(self, other):
        return self._math("SUBTRACT", self, other)

    def __rsub__(self, other):
        return self._math("SUBTRACT", other, self)

    def __mul__(self, other):
        return self._math("MULTIPLY", self, other)

    def __rmul__(self, other):
        return self._math("MULTIPLY", other, self)

    def __truediv__(self, other):
        return self._math("DIVIDE", self, other)

    def __rtruediv__(self, other):
        return self._math("DIVIDE", other, self)

    def __pow__(self, other):
        return self._math("POWER", self, other)

    def __neg__(self):
        return self * -1.0

    def __abs__(self):
        return self._math("ABSOLUTE", self)

    def __lt__(self, other):
        """1 or 0."""
        return self._math("LESS_THAN", self, other)

    def __gt__(self, other):
        return self._math("GREATER_THAN", self, other)

    def times_plus(self, factor, summand):
        return self._math("MULTIPLY_ADD", self, factor, summand)

    def at_most(self, other):
        return self._math("MINIMUM", self, other)

    def at_least(self, other):
        return self._math("MAXIMUM", self, other)

    def clamped(self, low, high):
        node = self.tree.nodes.new("ShaderNodeClamp")
        for socket, value in zip(node.inputs, (self, low, high), strict=True):
            Scalar(self.tree, value).feed(socket)
        return Scalar(self.tree, node.outputs[0])

    def sqrt(self):
        return self._math("SQRT", self)

    def floor(self):
        return self._math("FLOOR", self)

    def exp(self):
        return self._math("EXPONENT", self)

    def log(self):
        return self._math("LOGARITHM", self, 2.718281828459045)

    def cos(self):
        return self._math("COSINE", self)

    def sin(self):
        return self._math("SINE", self)

    def atan2(self, x):
        """The angle of the point (x, self)."""
        return self._math("ARCTAN2", self, x)

    def choose(self, one, zero):
        """`one` where self is 1, `zero` where it is 0."""
        kind = "VECTOR" if isinstance(one, Vector) or isinstance(zero, Vector) else "FLOAT"
        made = Vector if kind == "VECTOR" else Scalar
        node = self.tree.nodes.new("ShaderNodeMix")
        node.data_type = kind
        node.clamp_factor = False
        # The Mix node has one socket of each name per data type: go by identifier.
        sockets = {s.identifier: s for s in (*node.inputs, *node.outputs)}
        self.feed(sockets["Factor_Float"])
        made(self.tree, zero).feed(sockets[f"A_{kind.title()}"])
        made(self.tree, one).feed(sockets[f"B_{kind.title()}"])
        return made(self.tree, sockets[f"Result_{kind.title()}"])


class Vector(_Value):
    @classmethod
    def of(cls, x, y, z=0.0):
        tree = next(v.tree for v in (x, y, z) if isinstance(v, Scalar))
        node = tree.nodes.new("ShaderNodeCombineXYZ")
        for socket, value in zip(node.inputs, (x, y, z), strict=True):
            Scalar(tree, value).feed(socket)
        return cls(tree, node.outputs[0])

    def _math(self, operation, *values):
        return Vector(self.tree, self._node("ShaderNodeVectorMath", operation, values).outputs[0])

    def components(self):
        node = self.tree.nodes.new("ShaderNodeSeparateXYZ")
        self.feed(node.inputs[0])
        return [Scalar(self.tree, socket) for socket in node.outputs]

    def __add__(self, other):
        return self._math("ADD", self, other)

    def __sub__(self, other):
        return self._math("SUBTRACT", self, other)

    def __mul__(self, factor):
        """By a Scalar."""
        node = self._node("ShaderNodeVectorMath", "SCALE", (self,))
        Scalar(self.tree, factor).feed(node.inputs["Scale"])
        return Vector(self.tree, node.outputs[0])

    def at_least(self, other):
        """The larger one, component by component."""
        return self._math("MAXIMUM", self, other)

    def at_most(self, other):
        return self._math("MINIMUM", self, other)

    def bounded(self, limit):
        """Components within +-limit; -limit for what is not a number."""
        low = Vector(self.tree, (-limit,) * 3)
        # Which argument a maximum drops if it is not a number differs between Blender's versions,
        # shading systems and folded constants: so both are asked.
        return low.at_least(self.at_least(low)).at_most((limit,) * 3)

    def dot(self, other):
        node = self._node("ShaderNodeVectorMath", "DOT_PRODUCT", (self, other))
        return Scalar(self.tree, node.outputs["Value"])

    def cross(self, other):
        return self._math("CROSS_PRODUCT", self, other)

    def normalized(self):
        return self._math("NORMALIZE", self)


def inputs(tree, start):
    """The values of the group's inputs, by name."""
    kinds = {"VALUE": Scalar, "VECTOR": Vector, "BOOLEAN": Scalar, "INT": Scalar}
    return {s.name: kinds[s.type](tree, s) for s in start.outputs if s.type in kinds and s.name}


def arrange(tree):
    """Place the nodes in columns from left to right, each behind all that feed it."""
    # A socket's own links are searched for in all of the tree's at every access.
    feeding = {}
    for wire in tree.links:
        feeding.setdefault(wire.to_node, []).append(wire.from_node)
    column = {}

    def place(node):
        if node not in column:
            column[node] = 0
            column[node] = 1 + max((place(other) for other in feeding.get(node, ())), default=-1)
        return column[node]

    filled = {}
    for node in tree.nodes:
        row = filled[place(node)] = filled.get(place(node), -1) + 1
        node.location = (column[node] * COLUMN, -row * ROW)
        if node.type not in ("GROUP_INPUT", "GROUP_OUTPUT"):
            node.hide = True
