# SPDX-License-Identifier: GPL-3.0-or-later
"""Short ways to write field arithmetic as Geometry Nodes."""


class Fields:
    """Adds nodes to a tree. Arguments are sockets (linked) or values."""

    def __init__(self, tree):
        self.tree = tree

    def node(self, kind, inputs=(), **settings):
        """A node with its settings made; inputs: {name: socket or value}."""
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for name, value in dict(inputs).items():
            self.put(next(s for s in node.inputs if s.enabled and s.name == name), value)
        return node

    def put(self, socket, value):
        if hasattr(value, "is_output"):
            self.tree.links.new(value, socket)
        else:
            socket.default_value = value

    @staticmethod
    def out(node, name=None):
        return next(s for s in node.outputs if s.enabled and name in (None, s.name))

    def _operation(self, kind, operation, arguments):
        node = self.tree.nodes.new(kind)
        node.operation = operation
        for socket, value in zip((s for s in node.inputs if s.enabled), arguments, strict=False):
            self.put(socket, value)
        return self.out(node)

    def math(self, operation, *arguments):
        return self._operation("ShaderNodeMath", operation, arguments)

    def integer(self, operation, *arguments):
        return self._operation("FunctionNodeIntegerMath", operation, arguments)

    def vector(self, operation, *arguments):
        return self._operation("ShaderNodeVectorMath", operation, arguments)

    def scale(self, vector, factor):
        node = self.node("ShaderNodeVectorMath", operation="SCALE")
        self.put(node.inputs[0], vector)
        self.put(node.inputs["Scale"], factor)
        return self.out(node)

    def combination(self, a, va, b, vb):
        """a va + b vb."""
        return self.vector("ADD", self.scale(va, a), self.scale(vb, b))

    def split(self, vector):
        return list(self.node("ShaderNodeSeparateXYZ", {"Vector": vector}).outputs)

    def join(self, x, y, z):
        return self.out(self.node("ShaderNodeCombineXYZ", {"X": x, "Y": y, "Z": z}))

    def at(self, value, index, domain, data_type="FLOAT_VECTOR"):
        """The value at another element."""
        return self.out(
            self.node(
                "GeometryNodeFieldAtIndex",
                data_type=data_type,
                domain=domain,
                inputs={"Value": value, "Index": index},
            )
        )

    def capture(self, geometry, domain, **values):
        """Evaluate fields once; return the geometry and the captured fields."""
        node = self.node("GeometryNodeCaptureAttribute", domain=domain)
        kinds = {"VECTOR": "VECTOR", "INT": "INT", "VALUE": "FLOAT"}
        self.put(node.inputs["Geometry"], geometry)
        for name, value in values.items():
            node.capture_items.new(kinds[value.type], name)
            self.put(node.inputs[name], value)
        return node.outputs["Geometry"], [node.outputs[name] for name in values]

    def store(self, geometry, name, value, domain, data_type="FLOAT_VECTOR"):
        """Store a named attribute; return the geometry."""
        return self.out(
            self.node(
                "GeometryNodeStoreNamedAttribute",
                data_type=data_type,
                domain=domain,
                inputs={"Geometry": geometry, "Name": name, "Value": value},
            )
        )

    def named(self, name, data_type="FLOAT_VECTOR"):
        return self.out(
            self.node(
                "GeometryNodeInputNamedAttribute", data_type=data_type, inputs={"Name": name}
            ),
            "Attribute",
        )

    def sample(self, geometry, value, index, domain, data_type="FLOAT_VECTOR"):
        """The value at an element of another geometry."""
        return self.out(
            self.node(
                "GeometryNodeSampleIndex",
                data_type=data_type,
                domain=domain,
                inputs={"Geometry": geometry, "Value": value, "Index": index},
            )
        )

    def total(self, value, group, data_type="FLOAT"):
        """The sum over the corners of one group."""
        node = self.node("GeometryNodeAccumulateField", data_type=data_type, domain="CORNER")
        for socket, given in zip(
            (s for s in node.inputs if s.enabled), (value, group), strict=True
        ):
            self.put(socket, given)
        return self.out(node, "Total")
