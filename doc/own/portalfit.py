#!/usr/bin/env python3
"""portalfit.py lines.csv portal.gltf: a fit of portals of one's own, in place of portalfit's.

For each cut it finds the plane in which the lines of light come closest together, the waist of the bundle, and writes
the outline of the crossings: one opening for each cut. portalfit finds several, and their depth in thick walls.
"""

import base64
import json
import sys

import numpy as np

KEPT = 0.99  # of the crossings, those nearest to their middle: the others may be leaks


def crossings(lines, origin, normal):
    """Where lines cross a plane the way the light goes, [n, 2] in its frame, and this frame."""
    a, way = lines[:, :3], lines[:, 3:] - lines[:, :3]
    along = way @ normal
    t = (origin - a) @ normal / np.where(along > 0, along, np.inf)
    passing = (along > 0) & (t > 0) & (t < 1)
    x = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    frame = np.array([x, np.cross(normal, x)]) / np.linalg.norm(x)
    return (a + t[:, None] * way - origin)[passing] @ frame.T, frame


def waist(lines):
    """The plane, origin and normal, of the least sqrt(det C) / share^3, C the covariance of the crossings."""
    way = lines[:, 3:] - lines[:, :3]
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    across = np.eye(3) - way[:, :, None] * way[:, None, :]
    middle = np.linalg.solve(across.sum(0), np.einsum("nij,nj->i", across, lines[:, :3]))  # nearest to all lines
    mean = way.mean(0) / np.linalg.norm(way.mean(0))
    _, (x, y) = crossings(lines, middle, mean)

    def plane(p):
        normal = mean + p[1] * x + p[2] * y
        return middle + p[0] * mean, normal / np.linalg.norm(normal)

    def cost(p):
        points, _ = crossings(lines, *plane(p))
        return np.sqrt(np.linalg.det(np.cov(points.T))) / (len(points) / len(lines)) ** 3 if len(points) > 9 else np.inf

    best, step = np.zeros(3), np.diag([0.1 * np.ptp(lines.reshape(-1, 3) @ mean), 0.3, 0.3])
    while step[1, 1] > 1e-3:
        better = min((best + s for s in (*step, *-step)), key=cost)
        best, step = (better, step) if cost(better) < cost(best) else (best, step / 2)
    return plane(best)


def portal(lines):
    """Triangles of the portal of one cut, their front the way the light goes, [n, 3]."""
    origin, normal = waist(lines)
    points, frame = crossings(lines, origin, normal)
    distance = np.einsum("ni,ij,nj->n", points, np.linalg.inv(np.cov(points.T)), points)
    points = points[distance <= np.quantile(distance, KEPT)]
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    outermost = dict.fromkeys(np.argmax(points @ [np.cos(angle), np.sin(angle)], axis=0))
    corners = origin + points[[*outermost]] @ frame
    return corners[[[0, i, i + 1] for i in range(1, len(corners) - 1)]].reshape(-1, 3).astype("<f4")


table = np.genfromtxt(sys.argv[1], delimiter=",", names=True)
lines = np.column_stack([table[name] for name in table.dtype.names[1:7]])
portals = [portal(lines[table["cut"] == cut]) for cut in np.unique(table["cut"])]
data, gltf = b"", {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [*range(len(portals))]}]}
gltf["nodes"] = [{"name": f"portal.{k}", "mesh": k} for k in range(len(portals))]
gltf["meshes"] = [{"primitives": [{"attributes": {"POSITION": k}}]} for k in range(len(portals))]
gltf["accessors"] = []
for p in portals:
    place = {"bufferView": 0, "byteOffset": len(data), "min": p.min(0).tolist(), "max": p.max(0).tolist()}
    gltf["accessors"].append({"componentType": 5126, "type": "VEC3", "count": len(p), **place})
    data += p.tobytes()
gltf["bufferViews"] = [{"buffer": 0, "byteLength": len(data)}]
uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
gltf["buffers"] = [{"uri": uri, "byteLength": len(data)}]
json.dump(gltf, open(sys.argv[2], "w"))
