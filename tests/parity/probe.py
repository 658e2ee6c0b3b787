"""Makes `probe.jsonl`: what MaterialX's own shaders compute for every texture-like output of its
standard library, at a few points, so that the test `parity` needs neither Python nor a device.

Run where PyPI's MaterialX 1.39.5, moderngl and numpy are installed, and EGL with llvmpipe:
`python tests/parity/probe.py`. GLSL comes from MaterialX's generator and is drawn into a float
framebuffer over a window of texture space; the values are those of scattered pixels, whose places
`tests/tests/parity.rs` computes in the same way.
"""
import json
import math
import os

import moderngl
import numpy as np
import MaterialX as mx
import MaterialX.PyMaterialXGenGlsl as gg
import MaterialX.PyMaterialXGenShader as gs

SIDE = 512
WINDOW = (0.0137, 0.0071, 1.0137, 1.0071)
VALUES = 64
SEARCH = mx.getDefaultDataSearchPath()
LIBRARY = mx.createDocument()
mx.loadLibraries(mx.getDefaultDataLibraryFolders(), SEARCH, LIBRARY)
COUNT = {"float": 1, "integer": 1, "boolean": 1, "vector2": 2, "vector3": 3, "color3": 3, "vector4": 4, "color4": 4}
CONTEXT = moderngl.create_standalone_context(backend="egl")
FRAME = CONTEXT.framebuffer([CONTEXT.renderbuffer((SIDE, SIDE), 4, dtype="f4")])

# What reads pictures, the surface or the scene: no function of texture space.
OUTSIDE = {
    "image": "reads a picture", "tiledimage": "reads a picture", "latlongimage": "reads a picture",
    "hextiledimage": "reads a picture", "triplanarprojection": "reads a picture",
    "hextilednormalmap": "reads a picture", "blur": "a convolution, which MaterialX's shader leaves out",
    "normal": "geometry", "tangent": "geometry", "bitangent": "geometry", "geomcolor": "geometry",
    "geompropvalue": "geometry", "bump": "geometry", "normalmap": "geometry", "flake2d": "geometry",
    "flake3d": "geometry", "reflect": "geometry", "refract": "geometry", "transformpoint": "geometry",
    "transformvector": "geometry", "transformnormal": "geometry", "viewdirection": "geometry",
    "facingratio": "geometry", "gooch_shade": "geometry", "frame": "an input of the scene",
    "time": "an input of the scene", "determinant": "a matrix",
}
# Coefficients (a, b, c) of a u + b v + c, by the kind of the probe.
WAVES = {
    "probe": [(0.55, 0.25, 0.1), (0.3, -0.4, 0.5), (-0.35, 0.45, 0.4), (0.2, 0.6, 0.15), (-0.5, -0.3, 0.9)],
    "wide": [(3.1, -2.3, -0.4), (-1.7, 2.9, 0.15), (2.2, 1.3, -1.6), (-0.9, -1.4, 1.7), (1.1, -2.6, 0.8)],
}
# The nodes upstream of those under test, by the kind of the probe.
SIGNALS = {"probe": {}, "wide": {}}
DRIVEN = {"in", "in1", "in2", "in3", "in4", "fg", "bg", "mask", "value", "value1", "value2", "valuel", "valuer",
          "valuet", "valueb", "valuetl", "valuetr", "valuebl", "valuebr", "iny", "inx", "x", "texcoord", "position"}
LITERALS = {
    "octaves": 4, "lacunarity": 1.9, "diminish": 0.6, "jitter": 0.7, "gamma": 1.4, "inlow": 0.1, "inhigh": 0.8,
    "outlow": -0.2, "outhigh": 1.3, "low": 0.3, "high": 0.65, "pivot": 0.35, "rotate": 30.0, "center": 0.4,
    "radius": 0.3, "thickness": 0.12, "size": 0.7, "seed": 3, "which": 2.3, "index": 1, "saturation": 0.6,
    "hue": 0.2, "lift": 0.1, "gain": 1.3, "contrast": 1.2, "contrastpivot": 0.4, "exposure": 0.5, "scale": 0.8,
    "num_intervals": 4, "interval1": 0.1, "interval2": 0.35, "interval3": 0.6, "interval4": 0.9, "interval_num": 2,
    "huelow": 0.1, "huehigh": 0.8, "saturationlow": 0.3, "saturationhigh": 0.9, "brightnesslow": 0.4,
    "brightnesshigh": 0.9, "outmin": -0.2, "outmax": 1.3, "min": 0.2, "max": 1.7, "operationorder": 1,
    "interpolation": 1, "type": 0, "style": 0, "clampoutput": False, "doclamp": True, "staggered": True,
}
WIDE = {"style": 1, "staggered": False, "operationorder": 0, "doclamp": False, "interpolation": 2, "type": 3,
        "clampoutput": True, "which": 7.6, "num_intervals": 3, "interval_num": 1}
VECTORS = {"pivot": (0.3, 0.2, 0.4, 0.1), "scale": (0.8, 1.3, 1.1, 0.9), "offset": (0.2, -0.1, 0.15, 0.3),
           "center": (0.4, 0.35, 0, 0), "uvtiling": (3, 2, 0, 0), "uvoffset": (0.3, 0.1, 0, 0), "freq": (3, 2, 4, 0),
           "point1": (0.2, 0.3, 0, 0), "point2": (0.7, 0.5, 0, 0), "axis": (0.2, 0.7, 0.5, 0),
           "lumacoeffs": (0.2, 0.5, 0.3, 0), "amplitude": (0.8, 1.2, 0.9, 1.1), "which": (0, 0, 0, 0)}
MATRICES = {"matrix33": [1.1, 0.2, 0.1, -0.3, 0.9, 0.2, 0.4, -0.2, 1.2],
            "matrix44": [1.1, 0.2, 0.1, 0.3, -0.3, 0.9, 0.2, 0.1, 0.4, -0.2, 1.2, 0.5, 0.2, 0.3, -0.1, 0.8]}


def pixels(count):
    """Scattered pixels: the additive recurrence of the plastic number (Roberts 2018)."""
    return [(int(SIDE * ((0.5 + 0.7548776662466927 * j) % 1)), int(SIDE * ((0.5 + 0.5698402909980532 * j) % 1)))
            for j in range(count)]


class Probe:
    """A document with one node under test, for MaterialX and for Mipless."""

    def __init__(self, kind):
        self.document = mx.createDocument()
        self.document.setDataLibrary(LIBRARY)
        self.graph = self.document.addNodeGraph("g")
        self.kind = kind
        self.made = {}

    def node(self, category, name, ty, definition=None, **inputs):
        node = self.graph.addNode(category, name, ty)
        if definition:
            node.setNodeDefString(definition)
        for port, (port_type, value) in inputs.items():
            port = node.addInput(port.rstrip("_"), port_type)
            if isinstance(value, mx.Node):
                port.setNodeName(value.getName())
            else:
                port.setValueString(value)
        return node

    def number(self, k):
        """The k-th number a u + b v + c."""
        name = f"float{k}"
        if name in self.made:
            return self.made[name]
        if "uv" not in self.made:
            uv = self.made["uv"] = self.node("texcoord", "uv", "vector2")
            for i, axis in enumerate("uv"):
                self.made[axis] = self.node("extract", axis, "float", in_=("vector2", uv), index=("integer", str(i)))
        a, b, c = WAVES[self.kind][k % 5]
        shift = 0.13 * (k // 5)
        along = self.node("multiply", name + "a", "float", in1=("float", self.made["u"]), in2=("float", repr(a)))
        across = self.node("multiply", name + "b", "float", in1=("float", self.made["v"]), in2=("float", repr(b)))
        both = self.node("add", name + "c", "float", in1=("float", along), in2=("float", across))
        self.made[name] = self.node("add", name, "float", in1=("float", both), in2=("float", repr(c + shift)))
        return self.made[name]

    def signal(self, ty, k):
        """The k-th signal of a type."""
        if ty == "float":
            return self.number(k)
        name = f"{ty}{k}"
        if name in self.made:
            return self.made[name]
        if ty in ("integer", "boolean"):
            x = self.number(k)
            if ty == "integer":
                scaled = self.node("multiply", name + "s", "float", in1=("float", x), in2=("float", "3.7"))
                made = self.node("floor", name, "integer", "ND_floor_integer", in_=("float", scaled))
            else:
                made = self.node("ifgreater", name, "boolean", "ND_ifgreater_boolean", value1=("float", x),
                                 value2=("float", "0.5"))
        else:
            n = COUNT[ty]
            parts = {f"in{i + 1}": ("float", self.number((k + 2 * i) % 5 + 5 * (k // 5 + i // 3))) for i in range(n)}
            made = self.node(f"combine{n}", name, ty, f"ND_combine{n}_{ty}", **parts)
        self.made[name] = made
        return made

    def place(self, category, ty):
        """Coordinates that reach a few cells of a noise, or beyond the unit square of a pattern."""
        noise = "noise" in category or "fractal" in category
        factors = [5.3, 4.1, 3.7] if noise else [1.7, 1.4, 1.2]
        parts = {}
        name = f"{'cells' if noise else 'place'}{COUNT[ty]}"
        self.number(0)
        for i, factor in enumerate(factors[:COUNT[ty]]):
            x = [self.made["u"], self.made["v"], self.number(2)][i]
            scaled = self.node("multiply", f"{name}{i}s", "float", in1=("float", x), in2=("float", repr(factor)))
            parts[f"in{i + 1}"] = ("float", self.node("subtract", f"{name}{i}", "float",
                                                      in1=("float", scaled), in2=("float", "0.3")))
        return self.node(f"combine{COUNT[ty]}", name, ty, f"ND_combine{COUNT[ty]}_{ty}", **parts)


def literal(port, ty, definition, kind):
    """A value that is not the default, as MaterialX and as JSON write it."""
    name = port.getName()
    if ty in MATRICES:
        return ",".join(map(repr, MATRICES[ty])), MATRICES[ty]
    if ty == "string":
        return None
    if ty in ("float", "integer", "boolean"):
        value = LITERALS.get(name, 0.6)
        if kind == "wide":
            value = WIDE.get(name, value)
        if ty == "boolean":
            value = bool(value)
            return str(value).lower(), value
        if ty == "integer":
            value = int(value)
        return repr(value), value
    n = COUNT[ty]
    if name in VECTORS:
        values = VECTORS[name][:n]
    else:
        base = LITERALS.get(name, 0.6)
        values = [round(base + d * 0.1, 6) for d in (0.0, 0.5, -0.3, 0.2)[:n]]
    return ",".join(map(repr, values)), list(values)


def shader(document, element):
    generator = gg.GlslShaderGenerator.create()
    context = gs.GenContext(generator)
    context.registerSourceCodeSearchPath(SEARCH)
    colors = gs.DefaultColorManagementSystem.create(generator.getTarget())
    colors.loadLibrary(document)
    generator.setColorManagementSystem(colors)
    made = generator.generate("s", element, context)
    return made.getSourceCode("vertex"), made.getSourceCode("pixel")


def draw(vertex, pixel):
    program = CONTEXT.program(vertex_shader=vertex, fragment_shader=pixel)
    x0, y0, x1, y1 = WINDOW
    view = np.array([[2 / (x1 - x0), 0, 0, -(x1 + x0) / (x1 - x0)], [0, 2 / (y1 - y0), 0, -(y1 + y0) / (y1 - y0)],
                     [0, 0, 0, 0], [0, 0, 0, 1]], "f4")
    for name in program:
        member = program[name]
        if isinstance(member, moderngl.Uniform):
            if name.startswith("u_world"):
                member.write(np.eye(4, dtype="f4").tobytes())
            elif name == "u_viewProjectionMatrix":
                member.write(view.T.copy().tobytes())
    quad = np.array([[x0, y0], [x1, y0], [x0, y1], [x1, y1]], "f4")
    attributes = {"i_position": np.c_[quad, np.zeros(4, "f4")], "i_texcoord_0": quad}
    buffers = []
    for name in program:
        member = program[name]
        if isinstance(member, moderngl.Attribute):
            # Every set of coordinates is the one.
            name_of = "i_texcoord_0" if name.startswith("i_texcoord") else name
            values = attributes.get(name_of, np.zeros((4, member.dimension), "f4")).astype("f4")
            missing = np.zeros((4, max(0, member.dimension - values.shape[1])), "f4")
            values = np.c_[values[:, :member.dimension], missing].astype("f4")
            buffers.append((CONTEXT.buffer(np.ascontiguousarray(values).tobytes()), f"{member.dimension}f", name))
    array = CONTEXT.vertex_array(program, buffers)
    FRAME.use()
    CONTEXT.viewport = (0, 0, SIDE, SIDE)
    FRAME.clear()
    array.render(moderngl.TRIANGLE_STRIP)
    out = np.frombuffer(FRAME.read(components=4, dtype="f4"), "f4").reshape(SIDE, SIDE, 4).copy()
    for made in (array, program, *(buffer for buffer, _, _ in buffers)):
        made.release()
    return out


def probe(definition, output, kind):
    category, ty = definition.getNodeString(), output.getType()
    base = "wide" if kind == "wide" else "probe"
    document = Probe(base)
    outputs = [o for o in definition.getActiveOutputs()]
    node = document.graph.addNode(category, "t", ty if len(outputs) == 1 else "multioutput")
    node.setNodeDefString(definition.getName())
    if len(outputs) > 1:
        for each in outputs:
            node.addOutput(each.getName(), each.getType())
    written = {}
    if kind != "defaults":
        for k, port in enumerate(definition.getActiveInputs()):
            name, port_type = port.getName(), port.getType()
            if name in DRIVEN and not port.getIsUniform() and port_type in COUNT and category != "constant":
                place = name in ("texcoord", "position")
                source = document.place(category, port_type) if place else document.signal(port_type, k)
                node.addInput(name, port_type).setNodeName(source.getName())
                written[name] = {"node": source.getName()}
            else:
                value = literal(port, port_type, definition, kind)
                if value is None:
                    continue
                node.addInput(name, port_type).setValueString(value[0])
                written[name] = value[1]
    end = document.graph.addOutput("out", ty)
    end.setNodeName("t")
    if len(outputs) > 1:
        end.setOutputString(output.getName())
    image = draw(*shader(document.document, end))
    n = COUNT[ty]
    values = [float(x) for i, j in pixels(VALUES // n) for x in image[j, i, :n]]
    if category == "asin":
        # The driver's arcsine is good to 3e-4; what it is of is drawn instead.
        end.removeAttribute("nodename")
        source = node.getInput("in")
        if source is None:
            values = [0.0] * len(values)
        else:
            end.setNodeName(source.getNodeName())
            image = draw(*shader(document.document, end))
            values = [float(np.arcsin(np.float64(x))) if abs(x) <= 1 else math.nan
                      for i, j in pixels(VALUES // n) for x in image[j, i, :n]]
    for made in document.graph.getNodes():
        if made.getName() != "t":
            SIGNALS[base][made.getName()] = {
                "type": made.getCategory(), "of": made.getType(),
                "inputs": {i.getName(): {"node": i.getNodeName()} if i.getNodeName() else json.loads(i.getValueString())
                           for i in made.getInputs()}}
    return {"definition": definition.getName(), "output": output.getName(), "type": ty, "case": kind, "node": category,
            "inputs": written,
            "values": [float(f"{x:.7g}") if math.isfinite(x) else None for x in values]}


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    cases = []
    with open(os.path.join(here, "probe.jsonl"), "w") as file:
        for definition in LIBRARY.getNodeDefs():
            source = definition.getSourceUri()
            if "stdlib" not in source and "nprlib" not in source:
                continue
            if definition.getNodeString() in OUTSIDE or definition.getName().startswith("ND_extract_matrix"):
                continue
            for output in definition.getActiveOutputs():
                if output.getType() not in COUNT:
                    continue
                for kind in ("defaults", "probe", "wide"):
                    try:
                        case = probe(definition, output, kind)
                    except Exception as error:
                        print(definition.getName(), kind, repr(error)[:300])
                        continue
                    cases.append(case)
        for line in [SIGNALS, *cases]:
            file.write(json.dumps(line, separators=(",", ":")) + "\n")
    print(len(cases), "cases")


if __name__ == "__main__":
    main()
