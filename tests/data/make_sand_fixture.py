#!/usr/bin/env python3
"""Cuts a window out of the single-pass fields of the published kernels and writes sand_passes.bin.

    make_sand_fixture.py FOLDER_OF_GOLDEN_PASSES OUTPUT

The file: lines of text `name width height rim type` (type f2 or f4), an empty line, then the cells of each line in that
order, row by row, little-endian. Inputs have a rim of 12 cells around the window, results none. Needs nothing but
Python.
"""
import ast
import struct
import sys
import zipfile

SIZE, RIM = 40, 12
CODES = {"<f2": "e", "<f4": "f"}


def load(path):
    """Arrays of an npz file: name -> (shape, type, flat values)."""
    out = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            raw = archive.read(name)
            wide = raw[6] > 1
            length = struct.unpack("<I" if wide else "<H", raw[8 : 12 if wide else 10])[0]
            start = 12 if wide else 10
            header = ast.literal_eval(raw[start : start + length].decode())
            count = 1
            for n in header["shape"]:
                count *= n
            code = CODES[header["descr"]]
            values = struct.unpack(f"<{count}{code}", raw[start + length :])
            out[name[:-4]] = (header["shape"], header["descr"][1:], values)
    return out


def cell_wind(field):
    """The published kernels keep wind at half resolution: its value at the centre of each cell, bilinear, periodic."""
    (rows, cols), _, values = field
    at = lambda y, x: values[(y % rows) * cols + x % cols]
    out = []
    for y in range(2 * rows):
        for x in range(2 * cols):
            px, py = (x + 0.5) / 2 - 0.5, (y + 0.5) / 2 - 0.5
            x0, y0 = int(px // 1), int(py // 1)
            u, v = px - x0, py - y0
            out.append(
                (1 - u) * (1 - v) * at(y0, x0) + u * (1 - v) * at(y0, x0 + 1)
                + (1 - u) * v * at(y0 + 1, x0) + u * v * at(y0 + 1, x0 + 1)
            )
    return ((2 * rows, 2 * cols), "f4", out)


def main(folder, target):
    state = load(f"{folder}/input.npz")
    state["wind_x"] = cell_wind(state["wind_x"])
    state["wind_y"] = cell_wind(state["wind_y"])
    n = state["sand"][0][0]
    layers = []  # name, field, rim
    for name in ("bedrock soil sand water moisture slab adv_slab veg_density abrasion_resistance wind_shadow "
                 "wind_x wind_y").split():
        layers.append((name, state[name], RIM))
    for file, names in (
        ("float_clamp/lift", ("sand", "slab")),
        ("float_clamp/deposit", ("bedrock", "sand", "soil", "slab", "reptation_slab")),
        ("float_wrap/advect_forward", ("advected_slab",)),
        ("float_wrap/wind_shadow", ("wind_shadow",)),
        ("float_wrap/wind_shadow_curved", ("wind_shadow",)),
        ("float_wrap/reptation_smooth", ("sand",)),
        ("float_wrap/reptation_angle", ("angle",)),
        ("float_clamp/reptation_off_angle", ("angle",)),
    ):
        result = load(f"{folder}/{file}.npz")
        for name in names:
            layers.append((f"{file.split('/')[1]}.{name}", result[name], 0))

    # The window that has most of everything: bare rock, thin sand, water, plants, shelter.
    def variety(x0, y0):
        kinds = [0] * 6
        for y in range(y0, y0 + SIZE):
            for x in range(x0, x0 + SIZE):
                i = y * n + x
                kinds[0] += state["sand"][2][i] <= 0.025
                kinds[1] += state["soil"][2][i] <= 0.025
                kinds[2] += state["water"][2][i] > 1e-5
                kinds[3] += state["veg_density"][2][i] > 0.2
                kinds[4] += 0.01 < state["wind_shadow"][2][i] < 0.99
                kinds[5] += state["moisture"][2][i] <= 0.05 and state["water"][2][i] <= 0
        return min(kinds)

    starts = range(RIM, n - SIZE - RIM, 8)
    x0, y0 = max(((x, y) for y in starts for x in starts), key=lambda p: variety(*p))
    print(f"window ({x0}, {y0}), rarest kind of cell: {variety(x0, y0)}")
    with open(target, "wb") as out:
        for name, (_, kind, _), rim in layers:
            out.write(f"{name} {SIZE} {SIZE} {rim} {kind}\n".encode())
        out.write(b"\n")
        for _, (_, kind, values), rim in layers:
            for y in range(y0 - rim, y0 + SIZE + rim):
                row = values[y * n + x0 - rim : y * n + x0 + SIZE + rim]
                out.write(struct.pack(f"<{len(row)}{CODES['<' + kind]}", *row))


if __name__ == "__main__":
    main(*sys.argv[1:])
