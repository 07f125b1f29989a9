"""Reads what the example `reader_cases` wrote with the readers that users have, and compares cell by cell.

    cargo run -p lumivox-voxels --example reader_cases -- FOLDER
    python3 readers.py FOLDER

NumPy reads .npz, pynrrd .nhdr, trimesh .binvox and .ply, OpenVDB itself .vdb. A reader that is not installed is
named as skipped; with `--all` that is a failure. If FOLDER also has what `lumivox voxelize builtin:cornell:0` writes as
`cornell.npz` and so on, these are compared with one another, and colours with where they must be in the Cornell box.
"""

import sys
from pathlib import Path

import numpy as np

folder = Path(sys.argv[1])
lines = (folder / "cells.txt").read_text().splitlines()
nx, ny, nz, side = (float(word) for word in lines[0].split())
dims = (int(nx), int(ny), int(nz))
table = np.array([[float(word) for word in line.split()] for line in lines[1:]])
cells = table[:, :3].astype(int)
centers = table[:, 3:6]
values = {"albedo": table[:, 6:9], "normal": table[:, 9:12], "area": table[:, 12:13], "place": table[:, 13:17]}
assert len(cells) > 1000


def near(a, b, tolerance, what):
    worst = np.abs(np.asarray(a, float) - np.asarray(b, float)).max()
    assert worst <= tolerance, f"{what}: off by {worst}"


def same_cells(found, what):
    found = set(map(tuple, np.asarray(found, int).tolist()))
    assert found == set(map(tuple, cells.tolist())), f"{what}: {len(found)} cells instead of {len(cells)}"


def npz():
    with np.load(folder / "a.npz") as data:
        assert data.files[0] == "occupancy" and str(data["axis_order"]) == "zyx"
        occupancy = data["occupancy"]
        assert occupancy.shape == dims[::-1] and occupancy.dtype == np.uint8
        k, j, i = np.nonzero(occupancy)
        found = np.stack([i, j, k], axis=1)
        same_cells(found, "npz")
        world = data["origin"] + (found + 0.5) * data["cell_size"]
        near(world, centers, 1e-5, "npz world")
        assert (np.floor((centers - data["origin"]) / data["cell_size"]).astype(int) == cells).all()
        low, high = data["albedo_range"]
        albedo = low + (high - low) * data["albedo"][k, j, i] / 255
        near(albedo, values["albedo"], 1e-6, "npz albedo")
        assert data["normal"].dtype == np.float16 and data["place"].dtype == np.float32
        near(data["normal"][k, j, i], values["normal"], 1e-6, "npz normal")
        near(data["area"][k, j, i], values["area"][:, 0], 1e-9, "npz area")
        near(data["place"][k, j, i], values["place"], 1e-5, "npz place")
        assert data["place"][occupancy == 0].max() == 0


def nhdr():
    import nrrd

    occupancy, header = nrrd.read(str(folder / "a.nhdr"))
    assert occupancy.shape == dims
    found = np.argwhere(occupancy)
    same_cells(found, "nhdr")
    order = np.lexsort((found[:, 0], found[:, 1], found[:, 2]))
    world = header["space origin"] + found[order] @ header["space directions"]
    near(world, centers, 1e-5, "nhdr world")
    place, header = nrrd.read(str(folder / "a.place.nhdr"))
    assert place.shape == (4, *dims) and place.dtype == np.float32
    i, j, k = cells.T
    near(place[:, i, j, k].T, values["place"], 1e-5, "nhdr place")
    normal, _ = nrrd.read(str(folder / "a.normal.nhdr"))
    near(normal[:, i, j, k].T.copy().view(np.float16), values["normal"], 1e-6, "nhdr normal")


def binvox():
    import trimesh

    grid = trimesh.load(str(folder / "a.binvox"), file_type="binvox", axis_order="xzy")
    found = np.argwhere(grid.encoding.dense)
    same_cells(found, "binvox")
    # trimesh puts the middles of the first and the last cell on the ends of the range; the format's own rule:
    with open(folder / "a.binvox", "rb") as file:
        head = dict(line.split(b" ", 1) for line in file.read(200).split(b"\ndata\n")[0].split(b"\n")[1:])
    translate = np.array([float(v) for v in head[b"translate"].split()])
    scale, dim = float(head[b"scale"]), int(head[b"dim"].split()[0])
    order = np.lexsort((found[:, 0], found[:, 1], found[:, 2]))
    near(translate + scale * (found[order] + 0.5) / dim, centers, 1e-5, "binvox world")


def ply():
    import trimesh

    points = trimesh.load(str(folder / "a.ply"))
    near(points.vertices, centers, 1e-6, "ply points")
    raw = points.metadata["_ply_raw"]["vertex"]["data"]
    near(np.stack([raw["nx"], raw["ny"], raw["nz"]], axis=1).reshape(-1, 3), values["normal"], 1e-6, "ply normal")
    near(np.asarray(raw["area"]).reshape(-1, 1), values["area"], 1e-9, "ply area")
    linear = values["albedo"]
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    near(points.colors[:, :3], 255 * srgb, 0.51, "ply colours")
    cubes = trimesh.load(str(folder / "cubes.ply"), process=False)
    faces = cubes.vertices[cubes.faces]
    near(faces.min(axis=(0, 1)), centers.min(axis=0) - side / 2, 1e-5, "cubes lower corner")
    # Faces look outwards: the enclosed volume is that of the cells.
    cubes.merge_vertices(merge_tex=True, merge_norm=True)
    near(cubes.volume, len(cells) * side**3, 1e-4 * len(cells) * side**3, "cubes volume")


def vdb():
    try:
        import openvdb
    except ImportError:
        import pyopenvdb as openvdb
    grids, _ = openvdb.readAll(str(folder / "a.vdb"))
    grids = {grid.name: grid for grid in grids}
    assert set(grids) == {"density", "albedo", "normal", "area", "place", "place_w"}, set(grids)
    density = grids["density"]
    assert density.gridClass == "fog volume" and density.activeVoxelCount() == len(cells)
    array = np.zeros(dims, np.float32)
    density.copyToArray(array)
    same_cells(np.argwhere(array == 1), "vdb")
    near([density.transform.indexToWorld(tuple(map(int, cell))) for cell in cells], centers, 1e-5, "vdb world")
    for name, columns in [("albedo", 3), ("normal", 3), ("place", 3), ("area", 1), ("place_w", 1)]:
        accessor = grids[name].getConstAccessor()
        found = np.array([accessor.getValue(tuple(map(int, cell))) for cell in cells]).reshape(-1, columns)
        wanted = values["place"][:, 3:4] if name == "place_w" else values[name][:, :columns]
        near(found, wanted, 1e-5, f"vdb {name}")


def middles(path):
    """Middles of the occupied cells of a file in the world, sorted, and sRGB or linear colours."""
    if path.suffix == ".npz":
        with np.load(path) as data:
            k, j, i = np.nonzero(data["occupancy"])
            points = data["origin"] + (np.stack([i, j, k], axis=1) + 0.5) * data["cell_size"]
            colors = data["albedo"][k, j, i] / 255
    elif path.suffix == ".nhdr":
        import nrrd

        occupancy, header = nrrd.read(str(path))
        found = np.argwhere(occupancy)
        points = header["space origin"] + found @ header["space directions"]
        colors = nrrd.read(str(path.with_suffix(".albedo.nhdr")))[0][:, *found.T].T / 255
    elif path.suffix == ".ply":
        import trimesh

        cloud = trimesh.load(str(path))
        points, srgb = np.asarray(cloud.vertices), cloud.colors[:, :3] / 255
        colors = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    else:
        try:
            import openvdb
        except ImportError:
            import pyopenvdb as openvdb
        density = openvdb.read(str(path), "density")
        albedo = openvdb.read(str(path), "albedo").getConstAccessor()
        cells = [tuple(item.min) for item in density.citerOnValues()]
        points = np.array([density.transform.indexToWorld(cell) for cell in cells])
        colors = np.array([albedo.getValue(cell) for cell in cells])
    order = np.lexsort(np.round(points / 1e-4).T)
    return points[order], colors[order]


def command():
    files = sorted(path for path in folder.glob("cornell.*") if path.suffixes in ([".npz"], [".nhdr"], [".ply"], [".vdb"]))
    assert len(files) == 4, files
    points, colors = middles(files[0])
    for path in files[1:]:
        other_points, other_colors = middles(path)
        near(other_points, points, 1e-4, path.name)
        near(other_colors, colors, 0.01, f"{path.name} colours")
    # Red on the left, green on the right, as one looks into the box along -z.
    middle_of = lambda wall: points[wall].mean(axis=0) - (points.min(axis=0) + points.max(axis=0)) / 2
    red = middle_of(colors[:, 0] > 2 * colors[:, 1])
    green = middle_of(colors[:, 1] > 2 * colors[:, 0])
    assert red[0] < -0.8 and green[0] > 0.8, (red, green)
    near(red[1:], green[1:], 0.05, "walls")


skipped = []
readers = [npz, nhdr, binvox, ply, vdb]
if (folder / "cornell.npz").exists():
    readers.append(command)
for reader in readers:
    try:
        reader()
        print(f"{reader.__name__}: equal")
    except ImportError as missing:
        skipped.append(reader.__name__)
        print(f"{reader.__name__}: skipped, {missing}")
if skipped and "--all" in sys.argv:
    sys.exit(f"not read: {', '.join(skipped)}")
