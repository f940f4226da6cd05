#!/usr/bin/env python3
"""A decoder of frames (PGF) written from geomcodec/FORMAT.md, section 14, alone. Slow.

usage: pgf_reference_decoder.py [REFERENCE.pgc FRAME.pgf MOTION]...   prints, per triple, what pgc_reference_decoder.py
does, of the frame. MOTION: 16 integers with commas between them where the decoder has a motion, else -
"""
import struct
import sys
import zlib

import pgc_reference_decoder as pgc

STILL = [1 << 30 if i % 5 == 0 else 0 for i in range(16)]


class FrameHeader(pgc.Fields):
    def __init__(self, b):
        assert b[:3] == b"PGF" and b[3] == 2
        self.b, self.at, flags = b, 5, b[4]
        assert flags < 128 and flags >> 1 & 3 < 3
        self.bits = None
        if flags & 1:
            self.bits, self.at = b[5], 30  # origin and step: 6 floats
        self.kind, self.motion = flags >> 1 & 3, STILL
        if self.kind == 1:
            self.motion = [self.signed() for _ in range(16)]
        self.vertices = self.varint()
        self.reference = struct.unpack_from("<I", b, self.at)[0]
        self.at += 4
        self.changed = [flags >> 3 + i & 1 for i in range(4)]
        sizes = [self.varint() if x else 0 for x in self.changed]
        self.take_sections(sizes)

    def signed(self):
        code = self.varint()
        return code >> 1 if code % 2 == 0 else -(code >> 1) - 1


def reference_checksum(header, vertices, faces, motion):
    out = [struct.pack("<I", header.bits | header.normal_bits << 8 | header.texcoord_bits << 16 | header.face_bits << 24)]
    for position, color, normal, texcoord in vertices:
        out.append(struct.pack("<3H4B2H2H", *position, *color, *normal, *texcoord))
    for corners, material, _ in faces:
        out.append(struct.pack("<%dI" % (len(corners) + 2), len(corners), *corners, material))
    for _, _, values in faces:
        out.append(struct.pack("<%dH" % len(values), *values))
    if motion:
        out.append(struct.pack("<16q", *motion))
    return zlib.crc32(b"".join(out))


def expect(position, motion, highest):
    rows = [sum(m * x for m, x in zip(motion[4 * i : 4 * i + 4], list(position) + [1])) for i in range(4)]
    at = [pgc.rnd(rows[i], rows[3]) for i in range(3)] if rows[3] > 0 else position
    return [max(0, min(highest, x)) for x in at]


class Group:
    def __init__(self, data, expected, neighbors, siblings, bits, highest):
        self.d, self.expected, self.values = pgc.Decoder(data), expected, []
        self.neighbors, self.classes, self.exact, self.last = neighbors, [], [], 1
        self.bits, self.highest = bits, highest
        self.share, self.follows_first = self.d.raw(4), self.d.raw(1)
        assert self.share <= 8
        for v, before in enumerate(expected):
            self.classes.append([0] * len(before))
            self.values.append(self.vertex(v, siblings[v]))
        self.d.finish()

    def vertex(self, v, sibling):
        around, n = self.neighbors[v], len(self.neighbors[v])
        prediction = list(self.expected[v])
        if sibling is not None:
            prediction = list(self.values[sibling])
        elif n and self.share:
            for c in range(len(prediction)):
                off = pgc.mean(sum(self.values[w][c] - self.expected[w][c] for w in around), n, 6)
                prediction[c] = max(0, min(self.highest, prediction[c] + (off * self.share + 256 >> 9)))
        exact = sum(self.exact[w] for w in around)
        state = 4 if sibling is not None else 0 if n == 0 else 1 if exact == n else 2 if exact else 3
        self.last = self.d.mixed(("exact 1", state, self.last), ("exact 2", min(7, exact)))
        self.exact.append(self.last)
        if self.last:
            return prediction
        other, first, value = 0, 0, []
        for c, p in enumerate(prediction):
            p = max(0, min(self.highest, p + first))
            if n:
                scale = pgc.mean(sum(self.classes[w][c] for w in around), n, 1)
            else:
                scale = 2 * self.classes[v - 1][c] if v else 0
            r = self.d.residual(("scale", c, scale), ("other", c, other), ("detail", c))
            value.append(p + r & (1 << self.bits) - 1)
            assert value[-1] <= self.highest
            self.classes[v][c] = abs(r).bit_length()
            other = max(other, self.classes[v][c])
            if c == 0 and self.follows_first:
                first = r
        return value


def decode_frame(reference, data, callers_motion):
    header, frame = pgc.Header(reference), FrameHeader(data)
    vertices, faces = pgc.decode(reference)
    motion = callers_motion if frame.kind == 2 else frame.motion
    assert frame.vertices == len(vertices)
    assert frame.reference == reference_checksum(header, vertices, faces, motion if frame.kind == 2 else None)
    neighbors = [[] for _ in vertices]
    for corners, _, _ in faces:
        for k, v in enumerate(corners):
            for w in (corners[(k + 1) % len(corners)], corners[k - 1]):
                if w < v and len(neighbors[v]) < 12:
                    neighbors[v].append(w)
    newest, siblings = {}, []
    for v, vertex in enumerate(vertices):
        siblings.append(newest.get(tuple(vertex[0])))
        newest[tuple(vertex[0])] = v
    bits = frame.bits or header.bits
    grb = lambda c: [c[1], c[0], c[2], c[3]]
    groups = [[expect(v[0], motion, (1 << bits) - 1) for v in vertices], [grb(v[1]) for v in vertices],
              [list(v[2]) for v in vertices], [list(v[3]) for v in vertices]]
    widths = [bits, 8, header.normal_bits, header.texcoord_bits]
    for g in range(4):
        if frame.changed[g]:
            highest = (1 << widths[g]) - (2 if g == 2 else 1)
            alone = siblings if g == 0 else [None] * len(vertices)
            groups[g] = Group(frame.sections[g], groups[g], neighbors, alone, widths[g], highest).values
    groups[1] = [grb(c) for c in groups[1]]
    return list(zip(*groups)), faces


if __name__ == "__main__":
    for i in range(1, len(sys.argv), 3):
        files = [open(name, "rb").read() for name in sys.argv[i : i + 2]]
        given = None if sys.argv[i + 2] == "-" else [int(x) for x in sys.argv[i + 2].split(",")]
        decoded = decode_frame(*files, given)
        print(len(decoded[0]), len(decoded[1]), "%016x" % pgc.fnv(*decoded))
