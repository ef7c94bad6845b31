# SPDX-License-Identifier: GPL-3.0-or-later
"""The assembler: from graphs of values to rows of OP, CLOSURE and PROGRAM, checked.

What no result depends on is left out; what depends on constants alone is computed here and now, by the machine itself.
A program is a list of steps without jumps, so it ends.
"""

import numpy as np

from ..program_tables import CLOSURE, CURVE, CURVE_SIZE, IMAGE, MAX_REGISTERS, OP, PATCH, PROGRAM, TEXEL, TexelFormat
from . import link
from .graph import GraphError, Node, Part, Tiles, is_constant, nodes_below, width, without_twins
from .opcodes import ONLY_DISTANCE, SIGNATURES, Op

MOST_OPS = 4096
FORMATS = {np.uint8: TexelFormat.BYTE, np.float16: TexelFormat.HALF, np.float32: TexelFormat.FLOAT}
ENCODED = {np.uint8: TexelFormat.SRGB, np.float32: TexelFormat.SRGB_FLOAT}
FIELDS = {name: CLOSURE.fields[name][1] // 4 for name in CLOSURE.names}  # number of the float of each field


class ProgramTables:
    """All programs of a scene, as they grow. `attributes`, `instance_values`: names that programs ask for, by their
    numbers."""

    def __init__(self):
        self.programs, self.ops, self.closures, self.patches = [_program(0, 0, 0, 0)], [], [], []
        self.curves, self.images, self.texels = [], [], []
        self.attributes, self.instance_values = [], []
        self._rows, self._texel_count = {}, 0  # of curves and images

    def add(self, result=(0.0, 0.0, 0.0), closures=()):
        """Assemble a program. Returns its row of PROGRAM.

        Parameters
        ----------
        result : value of three floats
        closures : list of (row of CLOSURE, {field: value})

        Raises GraphError if it needs more steps or registers than there are.
        """
        result, *fields = without_twins([result, *(v for _, fields in closures for v in fields.values())])
        wanted, rest = [result, *fields], iter(fields)
        closures = [(row, dict(zip(names, rest, strict=False))) for row, names in closures]
        order = [n for n in nodes_below(wanted)]
        if len(order) > MOST_OPS:
            raise GraphError(f"{len(order)} operations; {MOST_OPS} are possible")
        known = self._constants(order)
        order = [n for n in order if n not in known]
        registers = _allocate(order, wanted, known)
        first_op, first_closure = len(self.ops), len(self.closures)
        read = _floats_read(order, wanted)
        for n in order:
            op = self._op(n, registers, known)
            if n.op in (Op.VORONOI, Op.VORONOI_OF_4) and read[n] == {0}:
                op["mode"] |= ONLY_DISTANCE
            self.ops.append(op)
        for row, fields in closures:
            row = row.copy()
            row["patches"] = len(self.patches)
            for field, value in fields.items():
                value = _known(value, known)
                if is_constant(value):
                    row[field] = value
                else:
                    self.patches.append((FIELDS[field], _register(value, registers), width(value)))
            row["patch_count"] = len(self.patches) - row["patches"]
            self.closures.append(row)
        row = _program(first_op, len(order), first_closure, len(closures))
        result = _known(result, known)
        if is_constant(result):
            row["constant"] = result
        else:
            row["result"] = _register(result, registers)
        self.programs.append(row)
        return len(self.programs) - 1

    def constant(self, value):
        """A value that depends on nothing, as numbers; other values as they are."""
        return _known(value, self._constants(nodes_below([value])))

    def tables(self, entries=()):
        """Tables of Scene by name. `entries`: entry points that the scene needs besides the machine's."""
        return {
            "programs": np.array(self.programs, PROGRAM),
            "ops": np.array(self.ops, OP),
            "closures": np.array(self.closures, CLOSURE),
            "patches": np.array(self.patches, PATCH),
            "kernels": link.kernels({int(op["family"]) for op in self.ops}, len(self.programs) > 1, entries),
            "curves": np.concatenate(self.curves) if self.curves else np.zeros(0, CURVE),
            "images": np.array(self.images, IMAGE),
            "texels": np.concatenate(self.texels).view(TEXEL) if self.texels else np.zeros(0, TEXEL),
        }

    # ---- Steps ----

    def _op(self, n, registers, known):
        signature = SIGNATURES[n.op]
        row = np.zeros(1, OP)[0]
        row["family"], row["code"], row["mode"], row["shift"] = signature.family, n.op, n.mode, n.shift
        row["data"] = self._data(signature.table, n.data)
        row["out"] = registers.get(n, 0)
        row["register"] = -1
        for k, operand in enumerate(n.operands):
            operand = _known(operand, known)
            if is_constant(operand):
                row["constant"][k] = operand
            else:
                row["register"][k] = _register(operand, registers)
        return row

    def _constants(self, order):
        """{node: floats of its result} for all that depend on nothing but constants."""
        known = {}
        for n in order:
            signature = SIGNATURES[n.op]
            if signature.varies or any(not is_constant(_known(operand, known)) for operand in n.operands):
                continue
            if signature.table == "images":
                continue  # an image at one place: rare, and needs the table of pixels
            op = self._op(n, {}, known)
            curves = np.concatenate(self.curves) if self.curves else np.zeros(0, CURVE)
            known[n] = link.run_step(op, curves)[: signature.width]
        return known

    # ---- What steps read ----

    def _data(self, table, data):
        if not table:
            return 0
        if table in ("attribute", "instance_values"):
            names = self.attributes if table == "attribute" else self.instance_values
            if data not in names:
                names.append(data)
            return names.index(data)
        if data not in self._rows:
            add = (
                self._add_curve
                if table == "curves"
                else self._add_tiles
                if isinstance(data, Tiles)
                else self._add_image
            )
            self._rows[data] = add(data)
        return self._rows[data]

    def _add_curve(self, curve):
        rows = np.zeros(CURVE_SIZE, CURVE)
        rows["value"] = np.asarray(curve.values, np.float32).reshape(CURVE_SIZE, 4)
        self.curves.append(rows)
        return (len(self.curves) - 1) * CURVE_SIZE

    def _add_image(self, image):
        height, width, channels = image.pixels.shape
        row = np.zeros(1, IMAGE)[0]
        row["width"], row["height"], row["channels"] = width, height, channels
        row["format"] = (ENCODED if image.is_srgb else FORMATS)[image.pixels.dtype.type]
        row["first"] = self._texel_count
        raw = np.ascontiguousarray(image.pixels).view(np.uint8).ravel()
        words = np.zeros(-(-raw.size // 4), np.uint32)
        words.view(np.uint8)[: raw.size] = raw
        self.texels.append(words)
        self._texel_count += len(words)
        self.images.append(row)
        return len(self.images) - 1

    def _add_tiles(self, tiles):
        rows = [self._data("images", image) for image in tiles.images]
        header = np.zeros(1, IMAGE)[0]
        header["width"], header["height"] = tiles.columns, len(tiles.images) // tiles.columns
        header["channels"], header["format"], header["first"] = 4, TexelFormat.TILES, len(self.images) + 1
        self.images += [header, *(self.images[row] for row in rows)]
        return int(header["first"]) - 1


def _program(ops, op_count, closures, closure_count):
    row = np.zeros(1, PROGRAM)[0]
    row["ops"], row["op_count"], row["closures"], row["closure_count"] = ops, op_count, closures, closure_count
    row["result"] = -1
    return row


def _known(value, known):
    """The value as numbers, if it is known."""
    if isinstance(value, Part) and value.node in known:
        floats = known[value.node][value.offset : value.offset + value.width]
    elif isinstance(value, Node) and value in known:
        floats = known[value]
    else:
        return value
    return float(floats[0]) if len(floats) == 1 else tuple(float(f) for f in floats)


def _register(value, registers):
    return registers[value.node] + value.offset if isinstance(value, Part) else registers[value]


def _floats_read(order, wanted):
    """{node: numbers of those of its floats that others read}"""
    read = {n: set() for n in order}
    for value in (*wanted, *(operand for n in order for operand in n.operands)):
        node, first = (value.node, value.offset) if isinstance(value, Part) else (value, 0)
        if isinstance(node, Node) and node in read:
            read[node].update(range(first, first + width(value)))
    return read


def _allocate(order, wanted, known):
    """{node: its first register}: each is free again after the last step that reads it."""
    last = {}
    for step, n in enumerate(order):
        for operand in n.operands:
            if not is_constant(_known(operand, known)):
                last[operand.node if isinstance(operand, Part) else operand] = step
    for value in wanted:
        if not is_constant(_known(value, known)):
            last[value.node if isinstance(value, Part) else value] = len(order)
    used, registers, ends = np.zeros(MAX_REGISTERS, bool), {}, {}
    for step, n in enumerate(order):
        # an operation may read an operand after it wrote a part of its result: both need their own registers
        for done in ends.pop(step - 1, ()):
            used[registers[done] : registers[done] + done.width] = False
        run = np.lib.stride_tricks.sliding_window_view(used, n.width)
        free = np.flatnonzero(~run.any(axis=1))
        if not len(free):
            raise GraphError(f"more than {MAX_REGISTERS} numbers are needed at the same time")
        registers[n] = int(free[0])
        used[registers[n] : registers[n] + n.width] = True
        ends.setdefault(last.get(n, step), []).append(n)
    return registers
