#!/usr/bin/env python3
"""A decoder of PGC streams written from geomcodec/FORMAT.md alone, to prove that the page suffices. Slow.

usage: pgc_reference_decoder.py FILE.pgc...   prints, per file: vertices, faces, FNV-1a hash of everything decoded
"""
import math
import os
import re
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


WEIGHT = [1024, 920, 640, 380, 210, 115, 62, 33, 18, 10, 6, 4]


def read_table(name, sets, contexts, symbols=16):  # [set][context][class]
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "geomcodec", name)
    numbers = [int(x) for x in re.findall(r"\d+", open(path).read())]
    assert len(numbers) == sets * contexts * symbols
    rows = [numbers[i : i + symbols] for i in range(0, len(numbers), symbols)]
    return [rows[i : i + contexts] for i in range(0, len(rows), contexts)]


def walk_shares():  # section 15, connectivity
    def shares(weights):
        starts = [i + 2040 * sum(weights[:i]) // sum(weights) for i in range(9)]
        return [b - a for a, b in zip(starts, starts[1:])] + [0] * 8

    return [shares(row) for row in read_table("walk_priors.inc", 1, 696, 8)[0]]


def read_priors():  # the sets of classes, the sets of details
    return read_table("priors.inc", 10, 52), read_table("detail_priors.inc", 3, 17)


class Symbols:  # section 3
    def __init__(self, used=16, halves=None, weights=None, trust=3):
        self.start = [2 * i + 32736 * min(i, used) // used for i in range(17)]
        self.seen = 0
        if halves is not None:
            sums = [0]
            for c in range(16):
                sums.append(sums[-1] + WEIGHT[min(11, abs(2 * c - halves))])
            self.start = [2 * i + 32736 * sums[i] // sums[16] for i in range(17)]
            self.seen = 3
        if weights is not None and any(weights):
            self.start = [2 * i + 32736 * sum(weights[:i]) // sum(weights) for i in range(17)]
            self.seen = trust

    def learn(self, symbol, slowest):
        step = min(32767, 655360 // (10 * self.seen + 16))
        for i in range(16):
            target = 2 * i if i <= symbol else 32768 - 2 * (16 - i)
            self.start[i] += (target - self.start[i]) * step >> 16
        self.seen = min(self.seen + 1, slowest)


class Models(dict):
    def __missing__(self, key):
        self[key] = Bit()
        return self[key]


class Decoder:
    def __init__(self, data):
        self.data, self.at, self.range, self.models = data, 0, M64, Models()
        self.used, self.bits = 0, int.from_bytes(data, "big")  # raw bits: the lowest ones are the last byte's
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
        value = self.bits >> self.used & ((1 << k) - 1)
        self.used += k
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

    def symbol(self, keys, used=16):
        models = []
        for key in keys:
            if key not in self.models:
                self.models[key] = Symbols(used)
            models.append(self.models[key])
        if len(models) == 1:
            start = [2 * x for x in models[0].start]
        else:
            a, b = (min(m.seen, 31) + 1 for m in models)
            w = max(1, min(31, (32 * a + (a + b) // 2) // (a + b)))
            start = [(x * w >> 4) + (y * (32 - w) >> 4) for x, y in zip(models[0].start, models[1].start)]
        shift = self.range.bit_length() - 16
        begin = [x * (self.range >> shift) >> 16 for x in start]
        symbol = max(i for i in range(16) if begin[i] <= self.code >> shift)
        self.code -= begin[symbol] << shift
        self.range = (begin[symbol + 1] - begin[symbol]) << shift
        self.normalize()
        for m, slowest in zip(models, (128, 18) if len(models) == 2 else (64,)):
            m.learn(symbol, slowest)
        return symbol

    # The contexts' last parts are a class in halves, a class. prior: weights of classes, of details.
    def residual(self, one, two, details, prior=None):
        for key, halves, context in ((one, one[-1], one[-1]), (two, 2 * two[-1], 34 + two[-1])):
            if key not in self.models:
                self.models[key] = Symbols(halves=halves, weights=prior and prior[0][context])
        length = self.symbol([one, two])
        if length == 0:
            return 0
        if length == 15:
            length += self.raw(1)
        modeled = min(length - 1, 3)
        key = details + (length,)
        if prior and any(prior[1][length]) and key not in self.models:
            self.models[key] = Symbols(weights=prior[1][length], trust=16)
        detail = self.symbol([key], 2 << modeled) & ((2 << modeled) - 1)
        x = 1 << modeled | detail & ((1 << modeled) - 1)
        left = length - 1 - modeled
        if left:
            x = x << left | self.raw(left)
        return -x if detail >> modeled else x

    def finish(self):
        assert len(self.data) <= self.at + (self.used + 7) // 8 <= len(self.data) + 8


class TableDecoder:  # section 15
    def __init__(self, data, contexts, expected, lanes=4):  # expected(context): its shares
        self.data, self.used, self.bits = data, 0, int.from_bytes(data, "big")
        self.forward, self.taken = int.from_bytes(data, "little"), 0
        self.tables, last = {}, None
        context = 0
        while context < contexts:
            kind = self.take(2)
            if kind == 0:
                for context in range(context, context + self.taken_number()):
                    if expected:
                        self.tables[context] = expected(context)
                context += 1
                continue
            if kind == 1:
                last = [0] * 16
                last[self.take(4)] = 2048
            elif kind == 2:
                highest = self.take(4)
                last = [self.taken_number() for _ in range(highest)]
                last += [2048 - sum(last)] + [0] * (15 - highest)
            assert sum(last) == 2048 and min(last) >= 0
            self.tables[context] = last
            context += 1
        assert context == contexts
        self.at = (self.taken + 7) // 8
        self.state = list(struct.unpack_from("<%dI" % lanes, data, self.at))
        self.at += 4 * lanes

    def take(self, k):
        value = self.forward >> self.taken & ((1 << k) - 1)
        self.taken += k
        return value

    def taken_number(self):
        length = self.take(4)
        return 1 << length - 1 | self.take(length - 1) if length else 0

    raw = Decoder.raw

    def symbol(self, lane, context):
        x, freq = self.state[lane], self.tables[context]
        slot, symbol, start = x & 2047, 0, 0
        while start + freq[symbol] <= slot:
            start += freq[symbol]
            symbol += 1
        x = freq[symbol] * (x >> 11) + slot - start
        if x < 65536:
            x = x << 16 | struct.unpack_from("<H", self.data, self.at)[0]
            self.at += 2
        self.state[lane] = x
        return symbol

    def residual(self, lane, context):
        length = self.symbol(lane, context)
        if length == 15:
            length += self.raw(1)
        if length == 0:
            return 0
        field, leading = self.raw(length), 1 << length - 1
        return -(leading | field & leading - 1) if field & leading else leading | field

    def number(self):
        length = self.raw(6)
        if length < 2:
            return length
        x, left = 1, length - 1
        while left > 0:
            k = min(16, left)
            x, left = x << k | self.raw(k), left - k
        return x

    def finish(self):
        assert set(self.state) == {65536} and self.at + (self.used + 7) // 8 == len(self.data)


class Fields:  # section 1, and what ends a header
    def varint(self):
        value = shift = 0
        while True:
            byte = self.b[self.at]
            self.at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def take_sections(self, sizes):
        b = self.b
        crc = struct.unpack_from("<I", b, self.at)[0]
        assert zlib.crc32(b[: self.at] + b[self.at + 4 :]) == crc
        self.at += 4
        self.sections = []
        for size in sizes:
            self.sections.append(b[self.at : self.at + size])
            self.at += size
        assert self.at == len(b)


class Header(Fields):  # section 2
    def __init__(self, b):
        assert b[:3] == b"PGC" and b[3] in (3, 4, 5, 6, 7, 8)
        self.flags, self.at, self.b = b[4], 5, b
        self.chooses = b[3] == 5
        self.tables = self.byte() if b[3] > 3 else 0
        features = self.byte() if b[3] > 5 else 0
        self.expects, self.expects_faces = features & 16 > 0, features & 32 > 0
        if b[3] > 5:
            assert (features & 13 and features < 16) if b[3] == 6 else features >> b[3] - 3 == 1
            assert not self.expects or self.tables & 60
            assert not self.expects_faces or self.tables & 1
            self.chooses = features & 2 > 0
        self.ranked, self.by_size = features & 4 > 0, features & 8 > 0
        assert (self.tables > 0 or b[3] != 4) and self.tables & ~(0x39 if features & 14 or self.chooses else 0x3D) == 0
        self.bits = self.byte()
        self.priors = read_priors() if self.flags & 64 else None
        self.origin, self.step = (0.0,) * 3, (1.0,) * 3
        if not self.flags & 4:
            self.origin = self.floats(3)
            self.step = self.floats(1) * 3 if self.flags & 8 else self.floats(3)
        self.normal_bits = self.byte() if self.flags & 16 else 0
        self.texcoord_bits = self.byte() if self.flags & 32 else 0
        if self.texcoord_bits:
            self.floats(3)
        self.face_bits, self.face_components = (self.byte(), self.byte()) if self.flags & 128 else (0, 0)
        self.used, self.split, self.isolated, self.faces = (self.varint() for _ in range(4))
        self.points, self.vertices = self.used - self.split, self.used + self.isolated
        extra = self.varint()
        self.corners, self.triangles = extra + 3 * self.faces, extra == 0
        self.degenerate = self.varint() if features & 1 else 0
        assert not features & 1 or 0 < self.degenerate < self.faces
        assert not features & 12 or self.faces
        self.highest = self.varint()
        self.color = None
        if self.flags & 2:
            self.color = list(b[self.at : self.at + 4])
            self.at += 4
        some = self.vertices > 0
        present = [self.faces > 0, self.split > 0, some, some and not self.color, some and self.normal_bits > 0,
                   some and self.texcoord_bits > 0, self.highest > 0, self.faces > 0 and self.face_bits > 0,
                   some and self.flags & 1 > 0, self.degenerate > 0]
        sizes = [self.varint() if x else 0 for x in present]
        self.take_sections(sizes)

    def byte(self):
        self.at += 1
        return self.b[self.at - 1]

    def decoder(self, section, contexts):
        data = self.sections[section]
        if not self.tables >> section & 1:
            return Decoder(data)
        if section == 0:
            return TableDecoder(data, contexts, self.expects_faces and walk_shares().__getitem__, 1 if self.expects_faces else 4)
        return TableDecoder(data, contexts, self.expects and self.expected(section))

    def expected(self, section):  # section 15
        priors = read_priors()[0]

        def starts(context):
            if section == 2:
                founded, scale = context // 35 % 3, min(33, context % 35)
                return Symbols(halves=scale, weights=priors[(0, 2, 3)[founded]][scale]).start
            if context >= 969:
                return Symbols(2).start
            if context < 105:
                scale = min(33, context % 35)
                return Symbols(halves=scale, weights=section == 3 and priors[4 + context // 35][scale] or None).start
            component, other = 1 + (context - 105) // 288, (context - 105) % 288 // 18
            trained = section == 3 and component < 3
            return Symbols(halves=2 * other, weights=priors[9][34 + other] if trained else None).start

        def shares(context):
            ends = [i + (x * 2032 >> 15) for i, x in enumerate(starts(context))]
            return [b - a for a, b in zip(ends, ends[1:])]

        return shares

    def floats(self, n):
        self.at += 4 * n
        return struct.unpack_from("<%df" % n, self.b, self.at - 4 * n)


class Connectivity:  # section 4
    def __init__(self, header):
        self.h, self.d = header, header.decoder(0, 696)
        self.tables = header.tables & 1 > 0
        self.faces, self.vertex, self.face_of, self.next, self.previous, self.twin = [], [], [], [], [], []
        self.open, self.starting, self.ending = [], {}, {}
        self.n_vertices, self.degrees, self.border = 0, {}, {}
        self.last_across, self.latest = 1, 0
        self.queue, self.queued = [], set()
        while len(self.faces) < header.faces - header.degenerate:
            gate = self.gate()
            if gate is None:
                corners = []
                size = 3 if header.triangles else 3 + (self.d.number() if self.tables else self.d.number("size", 3))
                for _ in range(size):
                    corners.append(self.table_corner(0, corners) if self.tables else self.corner("seed", corners))
                self.finish(corners, None)
            elif self.tables:
                self.table_gate(gate)
            elif self.across(gate):
                self.face(gate)
        self.walked = len(self.vertex)  # corners
        assert self.n_vertices == header.points and self.walked == header.corners - 3 * header.degenerate
        if header.faces:
            self.d.finish()
        if header.degenerate:
            self.degenerate_faces(Decoder(header.sections[9]))

    def degenerate_faces(self, d):  # section 16
        at, last, left = [0] * self.n_vertices, 0, self.h.degenerate
        for c in range(self.walked):
            t = self.twin[c]
            if t is not None and t < c:
                continue
            s, e, n = self.vertex[c], self.end(c), 0
            while left:
                another = d.mixed(("another 1", min(n, 2), at[s], at[e]), ("another 2", min(n, 2), last if n == 0 else 0))
                last = another if n == 0 else last
                if not another:
                    break
                at[s] = min(3, at[s] + 1)
                at[e] = min(3, at[e] + 1)
                one_point = d.bit("one point")
                kind = 2 * one_point + d.bit(("end", one_point))
                first = len(self.vertex)
                self.vertex += [(e, s, s), (e, s, e), (s, s, s), (e, e, e)][kind]
                self.twin += [(c, None, t), (c, t, None), (None, None, None), (None, None, None)][kind]
                self.face_of += [len(self.faces)] * 3
                self.next += [first + 1, first + 2, first]
                self.previous += [first + 2, first, first + 1]
                self.faces.append((first, 3))
                n, left = n + 1, left - 1
        assert left == 0
        d.finish()

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
        context = 0 if gate_size == 3 else 1 if gate_size == 4 else 2
        size = 3
        if not self.h.triangles:
            same = self.d.bit(("same size", context))
            size = gate_size if same else 3 + self.d.number("size", context)
        corners = [self.end(gate), self.vertex[gate]]
        for k in range(2, size):
            place = "only" if size == 3 else "first" if k == 2 else "middle" if k + 1 < size else "last"
            corners.append(self.corner(place, corners))
        self.finish(corners, gate)

    def candidates(self, corners):
        first, last = corners[0], corners[-1]
        return [self.before(last), self.after(first), self.after(self.after(first)), self.before(self.before(last))]

    def named(self, symbol, candidates):
        assert symbol < 6
        if symbol == 0:
            self.n_vertices += 1
        if symbol in (0, 5):
            return self.n_vertices - 1 - (self.d.number() if symbol else 0)
        return candidates[symbol - 1]

    def table_corner(self, place, corners):  # section 15
        c, left, right = [None] * 4, 0, 0
        if corners:
            c, left, right = self.candidates(corners), self.degree(corners[-1]), self.degree(corners[0])
        context = 480 + ((place * 6 + min(left, 5)) * 6 + min(right, 5)) * 2 + (c[0] != c[1])
        return self.named(self.d.symbol(0, context) if self.n_vertices else 0, c)

    def table_gate(self, gate):
        a, b = self.vertex[gate], self.end(gate)
        size = self.faces[self.face_of[gate]][1]
        between = self.before(a) != self.after(b)
        context = (((self.degree(a) * 6 + min(self.degree(b), 5)) * 2 + between) * 2 + self.border.get(a, 0)) * 2 + (size == 3)
        symbol = self.d.symbol(0, context)
        self.open[gate] = False
        if symbol == 6:
            self.border[a] = self.border[b] = 1
            return
        corners = [b, a]
        if symbol == 7:
            size = 3 if self.h.triangles else 3 + self.d.number()
        else:
            corners.append(self.named(symbol, self.candidates(corners)))
        for k in range(len(corners), size):
            corners.append(self.table_corner(0 if k == 2 else 1 if k + 1 < size else 2, corners))
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
        if self.n_vertices < self.h.points and self.d.mixed(one + (0,), two + (0,)):
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


class Seams:  # section 5
    def __init__(self, header, mesh):
        self.mesh, self.h = mesh, header
        self.corner_vertex, self.point, self.sibling, self.newest, self.last = [], [], [], {}, 0
        if header.split == 0:
            self.corner_vertex, self.point = list(mesh.vertex), list(range(header.used))
            self.sibling = [None] * header.used
            return
        self.d = Decoder(header.sections[1])
        for corner, point in enumerate(mesh.vertex):
            self.corner_vertex.append(self.choose(corner, point) if point in self.newest else self.add(point))
        assert len(self.point) == header.used
        self.d.finish()

    def add(self, point):
        self.point.append(point)
        self.sibling.append(self.newest.get(point))
        self.newest[point] = len(self.point) - 1
        return self.newest[point]

    def far(self, one, other, corner):
        if one >= corner or other >= corner:
            return 0
        return 1 if self.corner_vertex[one] == self.corner_vertex[other] else 2

    def choose(self, corner, point):
        mesh, entering, leaving, far_e, far_l = self.mesh, None, None, 0, 0
        edge = mesh.previous[corner]
        twin = mesh.twin[edge]
        if twin is not None and twin < corner:
            entering, far_e = self.corner_vertex[twin], self.far(edge, mesh.next[twin], corner)
        twin = mesh.twin[corner]
        if twin is not None and mesh.next[twin] < corner:
            leaving, far_l = self.corner_vertex[mesh.next[twin]], self.far(mesh.next[corner], twin, corner)
        relation = 0 if leaving is None else 1 if leaving == entering else 2
        asked = 0
        if entering is not None:
            asked += 1
            if self.d.mixed(("e1", far_e, far_l, relation), ("e2", far_e, self.last, relation == 2)):
                self.last = 0
                return entering
        if relation == 2:
            asked += 1
            if self.d.mixed(("l1", far_l, far_e), ("l2", far_l, self.last)):
                self.last = 0
                return leaving
        if len(self.point) < self.h.used and self.d.mixed(("n1", asked, far_e, far_l), ("n2", asked, self.last)):
            self.last = 1
            return self.add(point)
        self.last = 2
        vertex = len(self.point) - 1 - self.d.number("age")
        assert vertex >= 0 and self.point[vertex] == point
        return vertex


RECIPROCAL = [0, 65536, 32768, 21845, 16384, 13107, 10923, 9362, 8192, 7282, 6554, 5958, 5461]


def mean(total, count, bits=0):  # section 6
    return total * RECIPROCAL[count] + (1 << (15 - bits)) >> (16 - bits)


class Stencil:  # section 6; vertex: per corner; vertices below v are known
    def __init__(self, mesh, vertex, twin, corners, v):
        self.neighbors, self.parallelograms, self.twists, self.extended = [], [], [], False
        self.corners = min(12, len(corners))
        size = lambda c: mesh.faces[mesh.face_of[c]][1]
        nxt, prv = mesh.next, mesh.previous

        def tip(edge):
            t = twin[edge]
            if t is None or size(t) != 3 or vertex[prv[t]] >= v:
                return None
            return vertex[prv[t]]

        def quad(edge, entering):
            t = twin[edge]
            if t is None or size(t) != 4:
                return
            f, g, p, q = vertex[edge], vertex[t], vertex[nxt[nxt[t]]], vertex[prv[t]]
            if p < v and q < v:
                self.twists.append((g, p, f, q) if entering else (f, q, g, p))

        for c in corners:
            if len(self.neighbors) >= 12:
                break
            a, b = vertex[nxt[c]], vertex[prv[c]]
            self.neighbors = (self.neighbors + [x for x in (a, b) if x < v])[:12]
            if a >= v or b >= v:
                continue
            if size(c) == 3:
                t = twin[nxt[c]]
                if t is None or vertex[prv[t]] >= v:
                    continue
                d = vertex[prv[t]]
                self.parallelograms.append((a, b, d))
                if size(t) != 3:
                    continue
                left, right = tip(nxt[t]), tip(prv[t])
                if left is not None and right is not None:
                    self.twists.append((left, right, d, d))
            else:
                d = vertex[nxt[nxt[c]]]
                if d >= v:
                    continue
                self.parallelograms.append((a, b, d))
                if size(c) == 4:
                    quad(nxt[c], False)
                    quad(nxt[nxt[c]], True)
        if not self.parallelograms:
            for c in corners[:12]:
                a, b = vertex[nxt[c]], vertex[prv[c]]
                t = twin[nxt[c]]
                if a < v and t is not None and vertex[nxt[nxt[t]]] < v:
                    self.parallelograms.append((a, a, vertex[nxt[nxt[t]]]))
                t = twin[prv[prv[c]]]
                if b < v and t is not None and vertex[prv[t]] < v:
                    self.parallelograms.append((b, b, vertex[prv[t]]))
            self.extended = bool(self.parallelograms)
        self.parallelograms, self.twists = self.parallelograms[:12], self.twists[:12]
        n = len(self.parallelograms)
        self.basis = 2 if self.extended else 2 + min(n, 3) if n else 1 if self.neighbors else 0

    def parallelogram_sum(self, at):
        return sum(at(a) + at(b) - at(d) for a, b, d in self.parallelograms)

    def scale(self, v, at):
        if self.neighbors:
            return mean(sum(at(x) for x in self.neighbors), len(self.neighbors), 1)
        return 2 * at(v - 1) if v else 0


def rank_points(mesh, count):  # section 17
    at, rank, support, waiting = mesh.vertex, {}, [0] * count, [[], [], [], []]
    around = [[] for _ in range(count)]
    for corner, point in enumerate(at[: mesh.walked]):
        around[point].append(corner)

    def size(corner):
        return mesh.faces[mesh.face_of[corner]][1]

    def known(*corners):
        return all(at[c] in rank for c in corners)

    def put(point, level):
        support[point] = level
        waiting[level].append(point)

    def supported(corner):
        point = at[corner]
        if point not in rank and support[point] < 3:
            put(point, max(2, support[point] + 1))

    def across(edge):
        t = mesh.twin[edge]
        if t is None or size(t) != 3 or not known(edge, t):
            return
        here, there = mesh.previous[edge], mesh.previous[t]
        if known(here):
            supported(there)
        if known(there):
            supported(here)

    def inside(corner):
        n = mesh.next[corner]
        if known(n, mesh.previous[corner], mesh.next[n]):
            supported(corner)

    def take(point):
        rank[point] = len(rank)
        for c in around[point]:
            n, p = mesh.next[c], mesh.previous[c]
            for x in (at[n], at[p]):
                if x not in rank and support[x] == 0:
                    put(x, 1)
            if size(c) == 3:
                across(n)
                across(c)
            else:
                inside(mesh.previous[p])
                inside(p)
                inside(n)

    for start in range(count):
        if start in rank:
            continue
        take(start)
        level = 3
        while level:
            if not waiting[level]:
                level -= 1
                continue
            point = waiting[level].pop(0)
            if point not in rank and support[point] == level:
                take(point)
                level = 3
    return [rank[point] for point in range(count)]


class Positions:  # section 6
    def __init__(self, header, mesh):
        rank = rank_points(mesh, header.points) if header.ranked else list(range(header.points))
        self.point = [rank[x] for x in mesh.vertex]
        self.h, self.mesh, self.d = header, mesh, header.decoder(2, 315)
        self.tables = header.tables >> 2 & 1
        self.mask, self.half = (1 << header.bits) - 1, 1 << header.bits - 1
        self.read_weights()
        self.around = [[] for _ in range(header.points)]
        for corner, vertex in enumerate(self.point[: mesh.walked]):
            self.around[vertex].append(corner)
        self.find_parts()
        self.at, self.classes, self.error, self.last_choice = [], [], [[0, 0], [0, 0]], 0
        for v in range(header.points + header.isolated):
            self.at.append([0] * 3)
            self.classes.append([0] * 3)
            if self.raw:
                self.at[v] = [self.d.raw(header.bits) for _ in range(3)]
            else:
                self.vertex(v)
        self.d.finish()
        self.at = [self.at[x] for x in rank] + self.at[header.points :]

    def read_weights(self):
        raw = self.d.raw
        if self.tables:
            self.exact = self.period = 0
            self.raw, self.lifted = raw(1), raw(1)
            own = raw(1)
            self.share = [(((raw(8) if own else 0) ^ 128) - 128, 0) for _ in range(16)]
            return
        self.share, self.lifted, self.exact, self.period = [(0, 0)] * 16, 0, 0, 0
        self.raw = raw(1)
        if self.raw:
            return
        self.lifted, self.exact = raw(1), raw(1)
        self.period = raw(16) if raw(1) else 0
        if raw(1):
            for c in range(16):
                if raw(1):
                    self.share[c] = tuple((raw(8) ^ 128) - 128 for _ in range(2))

    def find_parts(self):
        self.parts, seen, mesh = [], 0, self.mesh
        for f, (first, n) in enumerate(mesh.faces):
            gate = mesh.twin[first]
            if (gate is None or mesh.face_of[gate] >= f) and (not self.parts or self.parts[-1] != seen):
                self.parts.append(seen)
            seen = max([seen] + [x + 1 for x in self.point[first : first + n]])
        self.lags, last = [], {}
        for i, first in enumerate(self.parts):
            size = (self.parts[i + 1] if i + 1 < len(self.parts) else seen) - first
            before = last.get(size) if self.h.by_size else self.parts[i - 1] if i else None
            self.lags.append(0 if before is None else first - before)
            last[size] = first

    def lag(self, v):  # and whether v is the first of a part, and what moved as it did
        if self.period:
            return self.period, False, v - 1
        if v >= self.h.points:
            return 0, False, None
        part = max(i for i, first in enumerate(self.parts) if first <= v)
        first = self.parts[part]
        if self.h.by_size:
            return (0 if first == v else self.lags[part]), False, first
        return self.lags[part], first == v, v - 1

    def predict(self, s, v):
        clamp = lambda x: max(0, min(self.mask, x))
        order, normal, spread = [0, 1, 2], [0, 0, 0], 0
        at = [0, 0, 0]
        if s.parallelograms:
            share = self.share[(0 if s.extended else min(3, len(s.parallelograms))) * 4 + max(0, min(3, s.corners - 4))]
            for axis in range(3):
                x = lambda w: self.at[w][axis]
                base = mean(s.parallelogram_sum(x), len(s.parallelograms), 6)
                off = mean(sum(x(w) for w in s.neighbors), len(s.neighbors), 6) - base
                twist = mean(sum(x(a) + x(b) - x(c) - x(d) for a, b, c, d in s.twists), len(s.twists), 6)
                at[axis] = base * 128 + off * share[0] + twist * share[1] + 4096 >> 13
                spread = max(spread, abs(off))
            spread = min(17, (spread >> 6).bit_length())
            if self.lifted:
                n = [0, 0, 0]
                for a, b, d in s.parallelograms[: 2 if self.tables else 12]:
                    u = [self.at[a][i] - self.at[d][i] for i in range(3)]
                    w = [self.at[b][i] - self.at[d][i] for i in range(3)]
                    for i in range(3):
                        j, k = (i + 1) % 3, (i + 2) % 3
                        n[i] += u[j] * w[k] - u[k] * w[j]
                for i, j in ((0, 1), (1, 2), (0, 1)):
                    if abs(n[order[i]]) > abs(n[order[j]]):
                        order[i], order[j] = order[j], order[i]
                normal = [n[i] for i in order]
        elif s.neighbors:
            at = [mean(sum(self.at[w][axis] for w in s.neighbors), len(s.neighbors)) for axis in range(3)]
        elif v:
            at = self.at[v - 1]
        return [clamp(x) for x in at], order, normal, spread, s.basis

    def vertex(self, v):
        s = Stencil(self.mesh, self.point, self.mesh.twin, self.around[v] if v < self.h.points else [], v)
        plain = self.predict(s, v)
        if self.tables:
            return self.code(v, s, plain)
        lag, first, anchor = self.lag(v)
        if lag == 0 or lag >= v:
            return self.code(v, s, plain)
        other = [max(0, min(self.mask, self.at[anchor][i] + self.at[v - lag][i] - self.at[anchor - lag][i])) for i in range(3)]
        error = self.error[first]
        self.code(v, s, (other, [0, 1, 2], [0, 0, 0], 0, 6) if error[1] < error[0] else plain)
        for k, prediction in enumerate((plain[0], other)):
            cost = sum(abs(self.at[v][i] - prediction[i]).bit_length() for i in range(3))
            error[k] += 64 * cost - error[k] >> 3

    def code(self, v, s, prediction):
        at, order, normal, other, basis = prediction
        if self.exact and self.h.chooses:
            at, basis = self.start(s, at, basis)
        elif self.exact and self.choose(v, s, at, basis):
            return
        missed = [0, 0, 0]
        scales = [s.scale(v, lambda x: self.classes[x][role]) for role in range(3)]
        for role in range(3):
            axis = order[role]
            expected = at[axis]
            if role == 2 and normal[2]:
                follows = -(normal[0] * missed[0] + normal[1] * missed[1])
                expected += rnd(follows, normal[2]) if normal[2] > 0 else rnd(-follows, -normal[2])
                expected = max(0, min(self.mask, expected))
            if self.tables:
                founded = 0 if s.extended else min(2, len(s.parallelograms))
                r = self.d.residual(role, (3 * role + founded) * 35 + scales[role])
            else:
                r = self.d.residual(("scale", role, basis, scales[role]), ("other", role, basis, other), ("detail", role),
                                self.h.priors and (self.h.priors[0][(0, 0, 1, 2, 3, 3, 1, 3)[basis]], self.h.priors[1][0]))
            self.at[v][axis] = expected + r & self.mask
            missed[role] = self.at[v][axis] - at[axis]
            self.classes[v][role] = abs(r).bit_length()
            other = self.classes[v][role] if role == 0 else max(other, self.classes[v][role])

    def candidates(self, s, at):
        candidates, corners = [None, list(at)], list(s.parallelograms)
        if self.h.chooses and corners:
            a, b, d = corners[0]
            corners += [(a, a, d), (b, b, d)]
        for a, b, d in corners:
            p = [max(0, min(self.mask, self.at[a][i] + self.at[b][i] - self.at[d][i])) for i in range(3)]
            if len(candidates) < 8 and p not in candidates:
                candidates.append(p)
        return candidates

    def start(self, s, at, basis):
        candidates = self.candidates(s, at)
        n = len(candidates)
        if n == 2:
            return at, basis
        choice = self.d.symbol([("choice 1", basis, n), ("choice 2", self.last_choice, n)], n)
        self.last_choice = choice if 0 < choice < n else 1
        return (candidates[choice], 7) if 1 < choice < n else (at, basis)

    def choose(self, v, s, at, basis):
        candidates = self.candidates(s, at)
        n = len(candidates)
        choice = self.d.symbol([("choice 1", basis, n), ("choice 2", self.last_choice, n)], n)
        self.last_choice = min(choice, 7)
        if choice == 0 or choice >= n:
            return False
        self.at[v] = candidates[choice]
        return True


class Attributes:  # sections 7 to 9
    def __init__(self, header, mesh, seams, positions):
        self.h, self.mesh, self.seams = header, mesh, seams
        self.vertex, self.twin = seams.corner_vertex, list(mesh.twin)
        for c, t in enumerate(mesh.twin):
            if t is not None and (self.vertex[c] != self.vertex[mesh.next[t]] or self.vertex[mesh.next[c]] != self.vertex[t]):
                self.twin[c] = None
        self.around = [[] for _ in range(header.vertices)]
        for corner, vertex in enumerate(self.vertex[: mesh.walked]):
            self.around[vertex].append(corner)
        self.position = [positions.at[seams.point[v] if v < header.used else v - header.split] for v in range(header.vertices)]
        self.stencils = [Stencil(mesh, self.vertex, self.twin, self.around[v], v) for v in range(header.vertices)]
        self.colors = [list(header.color or [0] * 4) for _ in self.position]
        self.normals = [[0, 0] for _ in self.position]
        self.texcoords = [[0, 0] for _ in self.position]
        if header.sections[3] or (self.position and not header.color):
            self.d, self.tables = header.decoder(3, 971), header.tables >> 3 & 1
            self.code_colors()
            self.d.finish()
        if self.position and header.normal_bits:
            self.d, self.tables = header.decoder(4, 971), header.tables >> 4 & 1
            self.code_normals()
            self.d.finish()
        if self.position and header.texcoord_bits:
            self.d, self.tables = header.decoder(5, 971), header.tables >> 5 & 1
            self.code_texcoords()
            self.d.finish()

    def sibling(self, v):
        return self.seams.sibling[v] if v < self.h.used else None

    def same_as_sibling(self, v, values, memory):
        w = self.sibling(v)
        if w is None:
            return False
        same = self.d.symbol(0, 969 + self.last_same) if self.tables else self.d.bit(("same", self.last_same))
        self.last_same = 1 if same else 0
        if self.last_same:
            values[v], memory[v] = list(values[w]), memory[w]
        return self.last_same

    def component(self, name, basis, scale, other, before, prior=None, rank=None):
        if self.tables:
            rank = name if rank is None else rank
            context = (0 if basis < 2 else 1 if basis < 4 else 2) * 35 + scale
            if rank:
                context = 105 + (rank - 1) * 288 + min(other, 15) * 18 + (scale + 1) // 2
            return self.d.residual(rank, context)
        sign = 0 if before == 0 else 1 if before > 0 else 2
        return self.d.residual((name, "scale", basis, scale), (name, "other", basis, other), (name, "detail", sign), prior)

    def code_colors(self):
        d, memory, self.last_same = self.d, {}, 1
        alpha = d.raw(8) if d.raw(1) else None
        shares = [0, 0] + [d.raw(8) for _ in range(4)]
        variance, covariance = 1024, {0: 1024, 2: 1024}
        for v, s in enumerate(self.stencils):
            memory[v] = 0
            if self.same_as_sibling(v, self.colors, memory):
                continue
            scale = s.scale(v, lambda x: memory[x])
            other = before = green = 0
            for channel in (1, 0, 2, 3):
                if channel == 3 and alpha is not None:
                    self.colors[v][3] = alpha
                    continue
                at = lambda x: self.colors[x][channel]
                if s.neighbors:
                    m = p = mean(sum(at(x) for x in s.neighbors), len(s.neighbors), 6)
                    if s.parallelograms:
                        p = mean(s.parallelogram_sum(at), len(s.parallelograms), 6)
                    spatial = 128 * m + shares[s.basis] * (p - m) + 4096 >> 13
                else:
                    w = self.sibling(v)
                    spatial = at(v - 1 if w is None else w) if v else 255
                prediction = spatial
                if channel in covariance:
                    c = covariance[channel] * 256
                    ratio = abs(c) // variance * (1 if c >= 0 else -1)
                    prediction += rnd(max(-512, min(512, ratio)) * green, 256)
                prediction = max(0, min(255, prediction))
                prior = None
                if self.h.priors and channel < 3:
                    prior = (self.h.priors[0][(4 if channel == 1 else 7) + (0, 0, 1, 1, 2, 2)[s.basis]],
                             self.h.priors[1][1 if channel == 1 else 2])
                r = self.component(channel, s.basis, scale, other, before, prior, (1, 0, 2, 3)[channel])
                level = self.colors[v][channel] = prediction + r & 255
                other, before = max(other, abs(r).bit_length()), r
                if channel == 1:
                    green, memory[v] = r, abs(r).bit_length()
                    variance = max(32, variance + 64 * green * green - (variance >> 7))
                elif channel in covariance:
                    covariance[channel] += 64 * (level - spatial) * green - (covariance[channel] >> 7)

    def folded(self, at, m):
        x, y = at
        if abs(y) == m and x < 0 or abs(x) == m and y < 0:
            return [x, y]
        return [-(m - abs(y)) if x < 0 else m - abs(y), -(m - abs(x)) if y < 0 else m - abs(x)]

    def face_normal(self, v):
        total, p, mesh = [0, 0, 0], self.position, self.mesh
        for c in self.around[v][:64]:
            a = [p[self.vertex[mesh.next[c]]][i] - p[v][i] for i in range(3)]
            b = [p[self.vertex[mesh.previous[c]]][i] - p[v][i] for i in range(3)]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                total[i] += a[j] * b[k] - a[k] * b[j]
        return total

    def code_normals(self):
        m, memory, self.last_same = (1 << self.h.normal_bits - 1) - 1, {}, 1
        wrap = lambda x: x - 2 * m - 1 if x > m else x + 2 * m + 1 if x < -m else x
        clamp = lambda x: max(-m, min(m, x))
        for v, s in enumerate(self.stencils):
            memory[v] = ((0, 0), (0, 0))
            if self.same_as_sibling(v, self.normals, memory):
                continue
            n = self.face_normal(v)
            length = sum(abs(x) for x in n)
            below = length > 0 and n[2] < 0
            if length:
                faces = [rnd(n[0] * m, length), rnd(n[1] * m, length)]
                basis = 5 if s.neighbors else 1
            else:
                w, basis = self.sibling(v), 0
                faces = []
                for i in range(2):
                    at = lambda x: self.normals[x][i] - m
                    if s.neighbors:
                        faces.append(mean(sum(at(x) for x in s.neighbors), len(s.neighbors)))
                    else:
                        faces.append((at(v - 1 if w is None else w)) if v else 0)
            actual, classes, off, other, before = [0, 0], [0, 0], [0, 0], 0, 0
            for i in range(2):
                prediction = faces[i]
                if length and s.neighbors:
                    step = mean(sum(memory[x][1][i] for x in s.neighbors), len(s.neighbors))
                    prediction += abs(step) // 2 * (1 if step >= 0 else -1)
                prediction = clamp(prediction)
                scale = s.scale(v, lambda x: memory[x][0][i])
                r = self.component(i, basis, scale, other, before)
                actual[i] = clamp(wrap(prediction + r))
                off[i] = clamp(actual[i] - faces[i]) if length else 0
                classes[i] = other = abs(r).bit_length()
                before = r
            memory[v] = (classes, off)
            if below:
                actual = self.folded(actual, m)
            self.normals[v] = [x + m for x in actual]

    def similar(self, v):
        sums, count = [[0.0, 0.0], [0.0, 0.0]], 0
        for c in self.around[v]:
            if count == 8:
                break
            a, b = self.vertex[self.mesh.next[c]], self.vertex[self.mesh.previous[c]]
            if a >= v or b >= v:
                continue
            dot = edge_edge = side_side = 0.0
            for i in range(3):
                edge = float(self.position[b][i] - self.position[a][i])
                side = float(self.position[v][i] - self.position[a][i])
                dot, edge_edge, side_side = dot + edge * side, edge_edge + edge * edge, side_side + side * side
            along, across = 0.5, 0.0
            if edge_edge > 0:
                along = dot / edge_edge
                across = math.sqrt(max(0.0, side_side * edge_edge - dot * dot)) / edge_edge
            ta, tb = self.texcoords[a], self.texcoords[b]
            x, y = float(tb[0] - ta[0]), float(tb[1] - ta[1])
            sums[0][0] += (ta[0] + along * x) - across * y
            sums[0][1] += (ta[1] + along * y) + across * x
            sums[1][0] += (ta[0] + along * x) + across * y
            sums[1][1] += (ta[1] + along * y) - across * x
            count += 1
        return sums, count

    def code_texcoords(self):
        mask, half = (1 << self.h.texcoord_bits) - 1, 1 << self.h.texcoord_bits - 1
        memory, self.last_same, orientation, error = {}, 1, 0, [0, 0]
        for v, s in enumerate(self.stencils):
            memory[v] = (0, 0)
            if self.same_as_sibling(v, self.texcoords, memory):
                continue
            sums, count = self.similar(v)
            w, plain = self.sibling(v), [0, 0]
            for i in range(2):
                at = lambda x: self.texcoords[x][i]
                if s.parallelograms:
                    plain[i] = mean(s.parallelogram_sum(at), len(s.parallelograms))
                elif s.neighbors:
                    plain[i] = mean(sum(at(x) for x in s.neighbors), len(s.neighbors))
                else:
                    plain[i] = at(v - 1 if w is None else w) if v else 0
            plain = [max(0, min(mask, x)) for x in plain]
            plain_basis = 4 if s.basis >= 3 or len(s.parallelograms) > 1 else s.basis
            shaped, shaped_basis = plain, plain_basis
            if count:
                shaped = [int(min(max(math.floor(x / count + 0.5), 0.0), float(mask))) for x in sums[orientation]]
                shaped_basis = 5 if count > 1 else 3
            chosen, basis = (plain, plain_basis) if error[1] < error[0] else (shaped, shaped_basis)
            other, before, classes = 0, 0, [0, 0]
            for i in range(2):
                r = self.component(i, basis, s.scale(v, lambda x: memory[x][i]), other, before)
                self.texcoords[v][i] = chosen[i] + r & mask
                classes[i] = other = abs(r).bit_length()
                before = r
            memory[v] = classes
            if count:
                t = self.texcoords[v]
                for k, p in enumerate((shaped, plain)):
                    cost = sum(abs(t[i] - p[i]).bit_length() for i in range(2))
                    error[k] += 64 * cost - error[k] >> 3
                missed = [abs(t[0] - sums[o][0] / count) + abs(t[1] - sums[o][1] / count) for o in range(2)]
                if missed[0] != missed[1]:
                    orientation = 0 if missed[0] < missed[1] else 1

    def result(self):
        return list(zip(self.position, self.colors, self.normals, self.texcoords))


def materials(header, mesh):  # section 10
    if header.highest == 0:
        return [0] * header.faces
    d, material, same = Decoder(header.sections[6]), [], 1
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


def face_values(header, mesh):  # section 10
    bits, n = header.face_bits, header.face_components
    if n == 0 or header.faces == 0:
        return [()] * header.faces
    d, values, classes, same = Decoder(header.sections[7]), [], [], 1
    mask, half = (1 << bits) - 1, 1 << bits - 1
    for f, (first, size) in enumerate(mesh.faces):
        twins = [mesh.twin[c] for c in range(first, first + size)]
        near = [mesh.face_of[t] for t in twins if t is not None and mesh.face_of[t] < f][:12]
        expected = values[near[0]] if near else values[f - 1] if f else [0] * n
        agreement = len(near) if len(near) < 2 else 2 if all(values[g] == expected for g in near) else 3
        same = d.bit(("same", same, agreement))
        classes.append([0] * n)
        values.append(list(expected))
        if same:
            continue
        basis, other, before = (0, 3, 4, 5)[min(3, len(near))], 0, 0
        for c in range(n):
            prediction, scale = expected[c], 2 * classes[f - 1][c] if f else 0
            if near:
                prediction = min(mean(sum(values[g][c] for g in near), len(near)), mask)
                scale = mean(sum(classes[g][c] for g in near), len(near), 1)
            sign = 0 if before == 0 else 1 if before > 0 else 2
            before = d.residual((c, "scale", basis, scale), (c, "other", basis, other), (c, "detail", sign))
            values[f][c] = prediction + before & mask
            classes[f][c] = abs(before).bit_length()
            other = max(other, classes[f][c])
    d.finish()
    return values


def restore_order(header, vertices, faces):  # section 11
    d = Decoder(header.sections[8])

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
    for f, (corners, material, values) in enumerate(faces):
        first, n = d.number("first"), len(corners)
        old = [vertex_number[corners[(k - first) % n]] for k in range(n)]
        old_faces[face_number[f]] = (old, material, values)
    d.finish()
    return old_vertices, old_faces


def decode(data):
    header = Header(data)
    mesh = Connectivity(header)
    seams = Seams(header, mesh)
    vertices = []
    if header.vertices:
        vertices = Attributes(header, mesh, seams, Positions(header, mesh)).result()
    corner_lists = [seams.corner_vertex[first : first + n] for first, n in mesh.faces]
    faces = list(zip(corner_lists, materials(header, mesh), face_values(header, mesh)))
    return restore_order(header, vertices, faces) if header.flags & 1 and vertices else (vertices, faces)


def fnv(vertices, faces):
    h = 1469598103934665603
    for fields in vertices:
        for x in [x for field in fields for x in field]:
            h = ((h ^ x) * 1099511628211) & M64
    for corners, material, _ in faces:
        for x in list(corners) + [material]:
            h = ((h ^ x) * 1099511628211) & M64
    for x in [x for _, _, values in faces for x in values]:
        h = ((h ^ x) * 1099511628211) & M64
    return h


if __name__ == "__main__":
    for name in sys.argv[1:]:
        decoded = decode(open(name, "rb").read())
        print(len(decoded[0]), len(decoded[1]), "%016x" % fnv(*decoded))
