#!/usr/bin/env python3
"""A decoder of PGC streams written from geomcodec/FORMAT.md alone, to prove that the page suffices. Slow.

usage: pgc_reference_decoder.py FILE.pgc...   prints, per file: vertices, faces, FNV-1a hash of everything decoded
"""
import struct
import sys
import zlib

M64 = (1 << 64) - 1


def rnd(a, n):
    return (2 * a + n) // (2 * n)


STEP = [rnd(131072, 2 * n + 3) for n in range(24)]


class Bit:  # section 3
    __slots__ = ("p", "n")

    def __init__(self):
        self.p, self.n = 32768, 0

    def learn(self, bit):
        self.p += (((65504 if bit else 32) - self.p) * STEP[self.n]) >> 16
        self.n = min(self.n + 1, 23)


class Models(dict):
    def __missing__(self, key):
        self[key] = Bit()
        return self[key]


class Decoder:
    def __init__(self, data):
        self.data, self.at, self.range, self.models = data, 0, M64, Models()
        self.code = self.word() << 32 | self.word()

    def word(self):
        word = 0
        for _ in range(4):
            word = word << 8 | (self.data[self.at] if self.at < len(self.data) else 0)
            self.at += 1
        return word

    def normalize(self):
        while self.range < 1 << 32:
            self.range = self.range << 32 & M64
            self.code = (self.code << 32 | self.word()) & M64

    def plain(self, p):
        ones = (self.range >> 16) * p
        bit = 1 if self.code < ones else 0
        if bit:
            self.range = ones
        else:
            self.code -= ones
            self.range -= ones
        self.normalize()
        return bit

    def raw(self, k):
        self.range >>= k
        value = min(self.code // self.range, (1 << k) - 1)
        self.code -= value * self.range
        self.normalize()
        return value

    def bit(self, key):
        model = self.models[key]
        bit = self.plain(model.p)
        model.learn(bit)
        return bit

    def mixed(self, one, two):
        m, q = self.models[one], self.models[two]
        w, v = min(q.p, 65536 - q.p) + 256, min(m.p, 65536 - m.p) + 256
        bit = self.plain((m.p * w + q.p * v) // (w + v))
        m.learn(bit)
        q.learn(bit)
        return bit

    def tree(self, key, k):
        node = 1
        for _ in range(k):
            node = 2 * node + self.bit(key + (node,))
        return node - (1 << k)

    def mixed_tree(self, one, two, k):
        node = 1
        for _ in range(k):
            node = 2 * node + self.mixed(one + (node,), two + (node,))
        return node - (1 << k)

    def mantissa(self, key, length):
        if length < 2:
            return length
        learned, left = min(2, length - 1), length - 1
        x = 1 << learned | self.tree(key + (length,), learned)
        left -= learned
        while left > 0:
            k = min(16, left)
            x = x << k | self.raw(k)
            left -= k
        return x

    def number(self, *key):
        length = min(32, self.tree(key + ("length",), 6))
        return self.mantissa(key + ("mantissa",), length)

    def residual(self, axis, basis, scale, other, sign_context):
        c = min(17, self.mixed_tree((axis, "scale", basis, scale), (axis, "other", basis, other), 5))
        if c == 0:
            return 0
        negative = self.bit((axis, "sign", basis, sign_context))
        x = self.mantissa((axis, "mantissa"), c)
        return -x if negative else x

    def finish(self):
        assert len(self.data) <= self.at <= len(self.data) + 8


class Header:  # section 2
    def __init__(self, b):
        assert b[:3] == b"PGC" and b[3] == 1
        self.flags, self.bits, self.at, self.b = b[4], b[5], 6, b
        self.origin, self.step = (0.0,) * 3, (1.0,) * 3
        if not self.flags & 4:
            self.origin = self.floats(3)
            self.step = self.floats(1) * 3 if self.flags & 8 else self.floats(3)
        self.used, self.isolated, self.faces = self.varint(), self.varint(), self.varint()
        self.corners = self.varint() + 3 * self.faces
        self.highest = self.varint()
        self.color = None
        if self.flags & 2:
            self.color = list(b[self.at : self.at + 4])
            self.at += 4
        sizes = [self.varint() for _ in range(5)]
        crc = struct.unpack_from("<I", b, self.at)[0]
        assert zlib.crc32(b[: self.at] + b[self.at + 4 :]) == crc
        self.at += 4
        self.sections = []
        for size in sizes:
            self.sections.append(b[self.at : self.at + size])
            self.at += size
        assert self.at == len(b)

    def floats(self, n):
        self.at += 4 * n
        return struct.unpack_from("<%df" % n, self.b, self.at - 4 * n)

    def varint(self):
        value = shift = 0
        while True:
            byte = self.b[self.at]
            self.at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value


class Connectivity:  # section 4
    def __init__(self, header):
        self.h, self.d = header, Decoder(header.sections[0])
        self.faces, self.vertex, self.face_of, self.next, self.previous, self.twin = [], [], [], [], [], []
        self.open, self.starting, self.ending = [], {}, {}
        self.n_vertices, self.degrees, self.border = 0, {}, {}
        self.last_across, self.latest = 1, 0
        self.queue, self.queued = [], set()
        while len(self.faces) < header.faces:
            gate = self.gate()
            if gate is None:
                corners = []
                for _ in range(3 + self.d.number("size", 3)):
                    corners.append(self.corner("seed", corners))
                self.finish(corners, None)
            elif self.across(gate):
                self.face(gate)
        assert self.n_vertices == header.used and len(self.vertex) == header.corners
        self.d.finish()

    def degree(self, v):
        return min(9, self.degrees.get(v, 0))

    def end(self, corner):
        return self.vertex[self.next[corner]]

    def newest(self, edges, v):
        corners = edges.get(v, [])
        while corners and not self.open[corners[-1]]:
            corners.pop()
        return corners[-1] if corners else None

    def before(self, v):
        corner = None if v is None else self.newest(self.ending, v)
        return None if corner is None else self.vertex[corner]

    def after(self, v):
        corner = None if v is None else self.newest(self.starting, v)
        return None if corner is None else self.end(corner)

    def gate(self):
        while self.queue:
            corner = self.newest(self.starting, self.queue[0])
            if corner is not None:
                return corner
            self.queued.discard(self.queue.pop(0))
        return None

    def across(self, gate):
        a, b = self.vertex[gate], self.end(gate)
        border = self.border
        bit = self.d.mixed(("across 1", self.degree(a), border.get(a, 0), self.last_across),
                           ("across 2", self.degree(b), border.get(b, 0), border.get(a, 0)))
        self.last_across = bit
        self.open[gate] = False
        if not bit:
            border[a] = border[b] = 1
        return bit

    def face(self, gate):
        gate_size = self.faces[self.face_of[gate]][1]
        size = 3 + self.d.number("size", 0 if gate_size == 3 else 1 if gate_size == 4 else 2)
        corners = [self.end(gate), self.vertex[gate]]
        for k in range(2, size):
            place = "only" if size == 3 else "first" if k == 2 else "middle" if k + 1 < size else "last"
            corners.append(self.corner(place, corners))
        self.finish(corners, gate)

    def corner(self, place, corners):
        candidates = [None] * 4
        left = right = 0
        if corners:
            first, last = corners[0], corners[-1]
            left, right = self.degree(last), self.degree(first)
            candidates = [self.before(last), self.after(first), self.after(self.after(first)), self.before(self.before(last))]
        have = (candidates[0] is not None) + 2 * (candidates[1] is not None) + 4 * (candidates[0] == candidates[1])
        answer = self.answer(candidates, (1, place, have, left), (2, place, have, right, self.latest))
        self.latest = answer
        if answer == 0:
            self.n_vertices += 1
            return self.n_vertices - 1
        if answer == 5:
            return self.n_vertices - 1 - self.d.number("any")
        return candidates[answer - 1]

    def answer(self, candidates, one, two):
        if self.n_vertices == 0:
            return 0
        if self.n_vertices < self.h.used and self.d.mixed(one + (0,), two + (0,)):
            return 0
        for i, candidate in enumerate(candidates):
            if candidate is None or candidate in candidates[:i]:
                continue
            if self.d.mixed(one + (i + 1,), two + (i + 1,)):
                return i + 1
        return 5

    def finish(self, corners, gate):
        first, n = len(self.vertex), len(corners)
        for k in range(n):
            self.vertex.append(corners[k])
            self.face_of.append(len(self.faces))
            self.next.append(first + (k + 1) % n)
            self.previous.append(first + (k - 1) % n)
            self.twin.append(None)
            self.open.append(False)
        self.faces.append((first, n))
        for corner in range(first, first + n):
            if corner == first and gate is not None:
                self.twin[corner], self.twin[gate] = gate, corner
            else:
                self.add(corner)
            self.degrees[self.vertex[corner]] = self.degrees.get(self.vertex[corner], 0) + 1

    def add(self, corner):
        a, b = self.vertex[corner], self.end(corner)
        if a == b:
            return
        edges = self.starting.get(b, [])
        edges[:] = [x for x in edges if self.open[x]]
        for other in edges[::-1][:32]:
            if self.end(other) == a:
                self.twin[corner], self.twin[other] = other, corner
                self.open[other] = False
                return
        self.open[corner] = True
        self.starting.setdefault(a, []).append(corner)
        self.ending.setdefault(b, []).append(corner)
        if a not in self.queued:
            self.queued.add(a)
            self.queue.append(a)


class Attributes:  # sections 5 and 6
    def __init__(self, header, mesh):
        self.h, self.mesh = header, mesh
        self.positions, self.colors = Decoder(header.sections[1]), Decoder(header.sections[2])
        self.around = [[] for _ in range(header.used)]
        for corner, vertex in enumerate(mesh.vertex):
            self.around[vertex].append(corner)
        self.vertices, self.classes, self.green_classes = [], [], []
        self.variance, self.covariance = 1024, {0: 1024, 2: 1024}
        for v in range(header.used + header.isolated):
            self.stencil(v)
            self.vertices.append(([0] * 3, header.color or [0] * 4))
            self.position(v)
            if not header.color:
                self.color(v)
        self.positions.finish()
        if not header.color:
            self.colors.finish()

    def stencil(self, v):
        mesh, self.neighbors, self.parallelograms = self.mesh, [], []
        corners = self.around[v] if v < self.h.used else []
        for c in corners:
            if len(self.neighbors) >= 12:
                break
            a, b = mesh.vertex[mesh.next[c]], mesh.vertex[mesh.previous[c]]
            self.neighbors = (self.neighbors + [x for x in (a, b) if x < v])[:12]
            if a >= v or b >= v:
                continue
            if mesh.faces[mesh.face_of[c]][1] == 3:
                twin = mesh.twin[mesh.next[c]]
                d = v if twin is None else mesh.vertex[mesh.previous[twin]]
            else:
                d = mesh.vertex[mesh.next[mesh.next[c]]]
            if d < v:
                self.parallelograms.append((a, b, d))
        if not self.parallelograms:
            for c in corners[:12]:
                a, b = mesh.vertex[mesh.next[c]], mesh.vertex[mesh.previous[c]]
                twin = mesh.twin[mesh.next[c]]
                if a < v and twin is not None and mesh.vertex[mesh.next[mesh.next[twin]]] < v:
                    self.parallelograms.append((a, a, mesh.vertex[mesh.next[mesh.next[twin]]]))
                twin = mesh.twin[mesh.previous[mesh.previous[c]]]
                if b < v and twin is not None and mesh.vertex[mesh.previous[twin]] < v:
                    self.parallelograms.append((b, b, mesh.vertex[mesh.previous[twin]]))
        self.parallelograms = self.parallelograms[:12]
        n = len(self.parallelograms)
        self.basis = 3 if n > 1 else 2 if n == 1 else 1 if self.neighbors else 0

    def neighbor_mean(self, value, factor=1):
        return rnd(factor * sum(value(x) for x in self.neighbors), len(self.neighbors))

    def parallelogram_mean(self, value, factor=1):
        total = sum(value(a) + value(b) - value(d) for a, b, d in self.parallelograms)
        return rnd(factor * total, len(self.parallelograms))

    def scale(self, v, value):
        return self.neighbor_mean(value) if self.neighbors else value(v - 1) if v else 0

    def position(self, v):
        self.classes.append([0] * 3)
        highest, other = (1 << self.h.bits) - 1, 0
        for axis in range(3):
            value = lambda x: self.vertices[x][0][axis]
            if self.parallelograms:
                prediction = self.parallelogram_mean(value)
            elif self.neighbors:
                prediction = self.neighbor_mean(value)
            else:
                prediction = value(v - 1) if v else 0
            prediction = max(0, min(highest, prediction))
            scale = self.scale(v, lambda x: self.classes[x][axis])
            residual = self.positions.residual(axis, self.basis, scale, other, 0)
            assert 0 <= prediction + residual <= highest
            self.vertices[v][0][axis] = prediction + residual
            self.classes[v][axis] = abs(residual).bit_length()
            other = max(other, self.classes[v][axis])

    def color(self, v):
        self.green_classes.append(0)
        scale = self.scale(v, lambda x: self.green_classes[x])
        other = sign_context = green = 0
        for channel in (1, 0, 2, 3):
            value = lambda x: self.vertices[x][1][channel]
            if self.neighbors:
                mean = self.neighbor_mean(value, 64)
                if self.parallelograms:
                    mean += rnd(3 * (self.parallelogram_mean(value, 64) - mean), 4)
                spatial = rnd(mean, 64)
            else:
                spatial = value(v - 1) if v else 255
            prediction = spatial
            if channel in self.covariance:
                c = self.covariance[channel] * 256
                ratio = abs(c) // self.variance * (1 if c >= 0 else -1)
                prediction += rnd(max(-512, min(512, ratio)) * green, 256)
            prediction = max(0, min(255, prediction))
            residual = self.colors.residual(channel, self.basis, scale, other, sign_context)
            level = prediction + residual
            assert 0 <= level <= 255
            self.vertices[v][1][channel] = level
            other = max(other, abs(residual).bit_length())
            sign_context = 0 if residual == 0 else 1 if residual > 0 else 2
            if channel == 1:
                green = residual
                self.green_classes[v] = abs(residual).bit_length()
                self.variance = max(32, self.variance + 64 * green * green - (self.variance >> 7))
            elif channel in self.covariance:
                self.covariance[channel] += 64 * (level - spatial) * green - (self.covariance[channel] >> 7)


def materials(header, mesh):  # section 7
    if header.highest == 0:
        return [0] * header.faces
    d, material, same = Decoder(header.sections[3]), [], 1
    for f, (first, _) in enumerate(mesh.faces):
        twin = mesh.twin[first]
        if twin is not None and mesh.face_of[twin] < f:
            expected = material[mesh.face_of[twin]]
        else:
            expected = material[f - 1] if f else 0
        same = d.bit(("same", same))
        material.append(expected if same else d.number("material"))
        assert material[-1] <= header.highest
    d.finish()
    return material


def restore_order(header, vertices, faces):  # section 8
    d = Decoder(header.sections[4])

    def permutation(n, name):
        previous, context, result = -1, 33, []
        for _ in range(n):
            code = d.number(name, context)
            context = code.bit_length()
            previous = (previous + 1 + (code >> 1 if code % 2 == 0 else -(code >> 1) - 1)) & 0xFFFFFFFF
            result.append(previous)
        assert sorted(result) == list(range(n))
        return result

    vertex_number = permutation(len(vertices), "vertex")
    face_number = permutation(len(faces), "face")
    old_vertices, old_faces = [None] * len(vertices), [None] * len(faces)
    for v, number in enumerate(vertex_number):
        old_vertices[number] = vertices[v]
    for f, (corners, material) in enumerate(faces):
        first, n = d.number("first"), len(corners)
        old = [vertex_number[corners[(k - first) % n]] for k in range(n)]
        old_faces[face_number[f]] = (old, material)
    d.finish()
    return old_vertices, old_faces


def decode(data):
    header = Header(data)
    mesh = Connectivity(header)
    vertices = Attributes(header, mesh).vertices
    corner_lists = [mesh.vertex[first : first + n] for first, n in mesh.faces]
    faces = list(zip(corner_lists, materials(header, mesh)))
    return restore_order(header, vertices, faces) if header.flags & 1 else (vertices, faces)


def fnv(vertices, faces):
    h = 1469598103934665603
    for position, color in vertices:
        for x in list(position) + list(color):
            h = ((h ^ x) * 1099511628211) & M64
    for corners, material in faces:
        for x in list(corners) + [material]:
            h = ((h ^ x) * 1099511628211) & M64
    return h


if __name__ == "__main__":
    for name in sys.argv[1:]:
        decoded = decode(open(name, "rb").read())
        print(len(decoded[0]), len(decoded[1]), "%016x" % fnv(*decoded))
