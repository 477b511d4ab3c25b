"""simplified.py drop SCENE.glb SHARE OUT.glb    without its smallest triangles, those that are SHARE of its area together
simplified.py compare WHOLE.portal.glb OTHER.portal.glb   what became of each portal: moved [m], turned [degrees], area

Paper, 4.1: "proper simplification does not affect the stability of the results". Triangles of lamps stay."""
import json
import struct
import sys

import numpy as np

KINDS = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


class Scene:
    def __init__(self, path):
        with open(path, "rb") as file:
            data = file.read()
        size = struct.unpack_from("<I", data, 12)[0]
        self.json, self.bin = json.loads(data[20:20 + size]), data[28 + size:]

    def values(self, accessor, width):
        a = self.json["accessors"][accessor]
        view = self.json["bufferViews"][a["bufferView"]]
        kind = np.dtype(KINDS[a["componentType"]])
        at = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        step = view.get("byteStride", width * kind.itemsize)
        return np.ndarray((a["count"], width), kind, self.bin, at, (step, kind.itemsize))

    def corners(self, primitive):
        if "indices" in primitive:
            return self.values(primitive["indices"], 1).ravel().astype("<u4")
        return np.arange(self.json["accessors"][primitive["attributes"]["POSITION"]]["count"], dtype="<u4")

    def placed_meshes(self):
        """(mesh, matrix) of each node that has one."""
        def visit(index, above):
            node = self.json["nodes"][index]
            here = above @ local(node)
            if "mesh" in node:
                yield node["mesh"], here
            for child in node.get("children", []):
                yield from visit(child, here)

        for root in self.json["scenes"][self.json.get("scene", 0)]["nodes"]:
            yield from visit(root, np.eye(4))

    def triangles(self, primitive, matrix):
        place = self.values(primitive["attributes"]["POSITION"], 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
        return place[self.corners(primitive)].reshape(-1, 3, 3)

    def emits(self, primitive):
        material = self.json.get("materials", [])[primitive["material"]] if "material" in primitive else {}
        return any(material.get("emissiveFactor", [0]))

    def replace_corners(self, primitive, corners):
        self.bin += b"\0" * (-len(self.bin) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": 4 * len(corners)})
        self.json["accessors"].append({"bufferView": len(self.json["bufferViews"]) - 1, "componentType": 5125,
                                       "count": len(corners), "type": "SCALAR"})
        self.bin += corners.astype("<u4").tobytes()
        primitive["indices"] = len(self.json["accessors"]) - 1

    def write(self, path):
        self.bin += b"\0" * (-len(self.bin) % 4)
        self.json["buffers"][0]["byteLength"] = len(self.bin)
        text = json.dumps(self.json, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(self.bin), len(text), 0x4E4F534A))
            file.write(text + struct.pack("<II", len(self.bin), 0x004E4942) + self.bin)


def local(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    out = np.eye(4)
    out[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]))
    out[:3, 3] = node.get("translation", [0, 0, 0])
    return out


def vectors(triangles):
    """Half the cross products of their edges: normal times area."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) / 2


def drop(scene, share):
    """The number of triangles dropped and of all. A mesh that is placed several times is as large as the first time."""
    area, of = {}, {}
    for mesh, matrix in scene.placed_meshes():
        for k, primitive in enumerate(scene.json["meshes"][mesh]["primitives"]):
            if primitive.get("mode", 4) == 4 and not scene.emits(primitive) and (mesh, k) not in area:
                area[mesh, k] = np.linalg.norm(vectors(scene.triangles(primitive, matrix)), axis=-1)
                of[mesh, k] = primitive
    everything = np.sort(np.concatenate(list(area.values())))
    gone = np.searchsorted(np.cumsum(everything), share * everything.sum(), side="right")
    least = everything[gone] if gone < len(everything) else np.inf
    for key, primitive in of.items():
        kept = area[key] >= least
        if not kept.any():
            kept[np.argmax(area[key])] = True  # an empty mesh is none
        if not kept.all():
            scene.replace_corners(primitive, scene.corners(primitive).reshape(-1, 3)[kept].ravel())
    return int(sum((area[k] < least).sum() for k in area)), len(everything)


def portals(path):
    """(centre, unit normal, area) of each."""
    scene, out = Scene(path), []
    if not scene.json.get("scenes", [{}])[0].get("nodes"):
        return out
    for mesh, matrix in scene.placed_meshes():
        triangles = scene.triangles(scene.json["meshes"][mesh]["primitives"][0], matrix)
        n = vectors(triangles)
        area = np.linalg.norm(n, axis=-1)
        normal = n.sum(0) / np.linalg.norm(n.sum(0))
        out.append(((triangles.mean(1) * area[:, None]).sum(0) / area.sum(), normal, area.sum()))
    return out


def compare(whole, other):
    """A phrase for each portal of the whole scene: what became of it, by the nearest of the other's."""
    if not whole:
        return "no portal to lose" + (", %d found" % len(other) if other else "")
    said = []
    for centre, normal, area in whole:
        if not other:
            said.append("lost")
            continue
        c, n, a = min(other, key=lambda p: np.linalg.norm(p[0] - centre))
        turned = np.degrees(np.arccos(np.clip(n @ normal, -1, 1)))
        said.append("moved %.3g m, turned %.1f degrees, area x %.2f" % (np.linalg.norm(c - centre), turned, a / area))
    return "; ".join(said) + (" (%d portals, not %d)" % (len(other), len(whole)) if len(other) != len(whole) else "")


def main(verb, *arguments):
    if verb == "drop":
        path, share, out = arguments
        scene = Scene(path)
        print("%d of %d" % drop(scene, float(share)))
        scene.write(out)
    else:
        print(compare(*map(portals, arguments)))


if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in ("drop", "compare"):
        sys.exit("usage: simplified.py drop SCENE.glb SHARE OUT.glb | compare WHOLE.portal.glb OTHER.portal.glb")
    main(*sys.argv[1:])
