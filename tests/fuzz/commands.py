"""The command lines of cases: every command of rigtri, with names of the file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, dataclass
from pathlib import Path
from random import Random

from rigtri.formats import GLTF_SUFFIXES
from rigtri.model.options import options_of
from rigtri.operations.axis_presets import PRESETS
from rigtri.operations.registry import OPERATIONS, options_class

# Commands whose output need not look as the source: a case does not compare the two. auto shares weights
# among twist joints, and constrain replaces what it has put there before.
CHANGING = frozenset(
    [
        *("add-posereader", "auto", "bake", "build", "conform", "constrain", "limit-weights", "make-limb"),
        *("merge-joints", "pose", "prune-joints", "rename-joints", "root-motion", "set-rest", "snap"),
        *("strip", "take-clips"),
    ]
)
# Commands that refuse, with 6, what would move the vertices of any file too far: they drop weights or shear.
MEASURING = frozenset(["build", "convert", "limit-weights", "merge-joints"])
# Commands whose output is no rig.
PICTURES = {"draw": ".svg", "view": ".html", "export-blender": ".py", "explain": ".svg", "spec-init": ".yaml"}
SPECS = (
    "steps: [{do: orient-joints, preset: maya}, {do: add-twist, limbs: auto}, "
    "{do: add-controls, whole-character: true}, {do: bake, to: controls}]",
    "steps: [{do: limit-weights}, {do: set-rest, pose: tpose}, {do: mirror}]",
    "steps: [{do: prune-joints, ends: true}, {do: merge-joints, still: true}, "
    "{do: rename-joints, to: unreal}]",
)


@dataclass
class Names:
    """What a file has: three joints in a row, nodes, nodes with a mesh, clips. is_rigged: by rigtri."""

    chain: list[str]
    nodes: list[str]
    meshes: list[str]
    clips: list[str]
    is_rigged: bool = False

    def node(self, random: Random) -> str:
        return random.choice(self.nodes or ["a"])

    def moment(self, random: Random) -> str:
        clip = random.choice(["rest", *self.clips])
        return clip if clip == "rest" else f"{clip}@{random.choice([0, 0.5, 7, -1])}"


def command(path: Path, place: Path, random: Random, names: Names, root: str) -> list[str]:
    """A command line for the file. Its target, if any, comes behind ``-o``."""
    chain = names.chain
    reading = []
    is_gltf = path.suffix in GLTF_SUFFIXES
    if is_gltf and random.random() < 0.15:
        reading.append("--lenient")
    if random.random() < (0.05 if root == "" else 0.95):
        reading += ["--root", root or random.choice(["#0", "arm", "/Root", "joint 0"])]
    if random.random() < (0.8 if names.is_rigged else 0.4):
        return of_all(path, place, random, names, reading)
    what = random.random()
    if what < 0.05:
        return ["inspect", str(path), *reading, *random.choice([[], ["--json"]])]
    if what < 0.06:
        return ["check", str(path), *random.choice([[], ["--json"], ["-v"]])]
    if what < 0.07:
        return ["diff", str(path), str(path), *reading]
    if what < 0.09:
        return ["verify", str(path), str(path), *reading]
    if random.random() < 0.1:
        target = path
        reading.append("--overwrite")
    else:
        target = place / "out" / f"out{path.suffix}"
        target.parent.mkdir()
    if what < 0.3:
        return ["add-polevector", str(path), "-o", str(target), *_pole(chain, random), *reading]
    more = ["--edit-target", "bare"] if not is_gltf and random.random() < 0.1 and target != path else []
    return ["orient-joints", str(path), "-o", str(target), *_axes(is_gltf, random), *reading, *more]


def _axes(is_gltf: bool, r: Random) -> list[str]:
    choices: list[list[str]] = [
        [],
        [],
        ["--snap"],
        ["--world"],
        ["--aim", "x", "--up", "z"],
        ["--aim", "-y", "--up", "x"],
        ["--up-from", "world:+y"],
        ["--up-from", "pole"],
        ["--up-from", "parent"],
        ["--up-from", "child"],
        ["--end", "keep"],
        ["--end", "world"],
        ["--end", "parent"],
        ["--branch", "average"],
        ["--branch", "first"],
        ["--offset", "0,0,90"],
        ["--offset", "10,20,30"],
        ["--mirror", "behavior"],
        ["--mirror", "blender"],
        ["--per-joint-plane"],
        ["--pose", "nodes"],
        ["--on-nonuniform-scale", "skip"],
        ["--on-nonuniform-scale", "split"],
        ["--on-nonuniform-scale", "error"],
        ["--joints", "*"],
        *(["--preset", name] for name in PRESETS),
    ]
    if is_gltf:
        choices += [["--unknown-node-ext", "ignore"], ["--resources", "relink"]]
    return r.choice(choices)


def _pole(chain: list[str], r: Random) -> list[str]:
    _, middle, _ = chain
    return r.choice(
        [
            ["--limbs", "auto"],
            ["--limb", *chain],
            ["--limb", *chain, "--bend", f"{middle}=0,0,1"],
            ["--limb", *chain, "--bend", f"{middle}=1,0,0", "--orientation", "aim"],
            ["--limb", *chain, "--bend", f"{middle}=0,1,0", "--check-clips", "--pose", "bind"],
            ["--chain", chain[0], chain[2], "--bend", f"{middle}=0,0,1", "--distance", "2"],
        ]
    )


Arguments = Callable[[Names, Random], list[str]]


def of_all(path: Path, place: Path, r: Random, names: Names, reading: list[str]) -> list[str]:
    """One of all other commands, each as often as any other; operations without an entry, too."""
    name = r.choice(sorted({*EVERY, *OPERATIONS} - {"orient-joints", "add-polevector"}))
    arguments = EVERY[name](names, r) if name in EVERY else _drawn(name, names, r)
    arguments = [str(path) if word == "SAME" else word for word in arguments]
    if name == "build":
        spec = place / "in" / "rig.yaml"
        spec.write_text(r.choice(SPECS), "utf-8")
        arguments += ["--spec", str(spec)]
    if name == "recognise" or "--check" in arguments or (name == "pose" and r.random() < 0.3):
        return [name, str(path), *arguments, *reading]
    suffix = PICTURES.get(name, path.suffix)
    if name == "convert":
        suffix = r.choice([".usda", ".usdc", ".usdz"] if path.suffix in GLTF_SUFFIXES else [".glb", ".gltf"])
    target = place / "out" / f"out{suffix}"
    target.parent.mkdir()
    return [name, str(path), "-o", str(target), *arguments, *reading]


def _drawn(name: str, n: Names, r: Random) -> list[str]:
    """Options of an operation by what they take: all that must be given, and some of the others."""
    found: list[str] = []
    for one in options_of(options_class(name)).values():
        if one.default is not MISSING and r.random() < 0.8:
            continue
        if one.hint is bool:
            found.append(one.flag)
        elif one.words:
            found += [one.flag, r.choice(one.words)]
        elif one.kind is not None and one.kind.low is not None:
            found += [one.flag, str(r.choice([one.kind.low, one.kind.low + 1]))]
        elif one.default is MISSING or (one.kind is not None and "node" in one.kind.name):
            found += [one.flag, n.node(r)]
    return found


EVERY: dict[str, Arguments] = {
    "freeze": lambda n, r: r.choice(
        [[], ["--scale"], ["--up-axis", "y"], ["--up-axis", "z"], ["--unit", "0.01"]]
    ),
    "rename-joints": lambda n, r: r.choice(
        [
            *(["--to", scheme] for scheme in ("mixamo", "unreal", "unity", "vrm", "godot", "rigify")),
            ["--name", f"{n.node(r)}=other"],
            ["--to", "unreal", "--prefix", "p:"],
        ]
    ),
    "set-rest": lambda n, r: r.choice(
        [*(["--pose", pose] for pose in ("tpose", "apose", "bind", n.moment(r))), ["--like", "SAME"]]
    ),
    "conform": lambda n, r: ["--to", r.choice(["unreal", "unity", "godot", "vrm", "mixamo"])],
    "add-root": lambda n, r: r.choice(
        [[], ["--name", "Base"], ["--above", n.node(r)], ["--profile", "unreal"]]
    ),
    "add-socket": lambda n, r: [
        *("--name", "socket", "--on", n.node(r)),
        *r.choice([[], ["--at", "0,1,0"], ["--aim", "+y", "--up", "+z"]]),
    ],
    "root-motion": lambda n, r: r.choice(
        [
            [],
            ["--mode", "remove"],
            ["--yaw"],
            ["--hips", n.chain[0]],
            ["--hips", n.chain[1], "--to", n.chain[0]],
            ["--mode", "remove", "--hips", n.chain[0]],
        ]
    ),
    "prune-joints": lambda n, r: r.choice([[], ["--ends"], ["--sockets"], ["--sockets", "--ends"]]),
    "merge-joints": lambda n, r: r.choice(
        [
            ["--still"],
            ["--max-joints", "3", "--tolerance", "1"],
            ["--joints", n.chain[2]],
            ["--joints", "*", "--tolerance", "1"],
        ]
    ),
    "limit-weights": lambda n, r: r.choice(
        [[], ["--tolerance", "1"], ["--max-influences", "1", "--tolerance", "1"], ["--normalise"]]
    ),
    "convert": lambda n, r: r.choice([[], [], ["--fps", "30"], ["--clip", "*"]]),
    "build": lambda n, r: [],
    "spec-init": lambda n, r: [],
    "add-controls": lambda n, r: r.choice(
        [
            ["--whole-character"],
            ["--joints", "*", "--root-control"],
            ["--ik", *n.chain],
            ["--ik", *n.chain, "--as", "joint", "--stretch"],
            ["--chain", n.chain[0], n.chain[2], "--shape", "cube", "--size", "2"],
        ]
    ),
    "add-twist": lambda n, r: [
        *r.choice([["--limbs", "auto"], ["--limb", *n.chain], ["--joint", *n.chain[:1], "--to", n.chain[1]]]),
        *r.choice([[], ["--split-weights"], ["--no-keys"], ["--count", "1"], ["--max-influences", "4"]]),
    ],
    "constrain": lambda n, r: [
        *("--type", (kind := r.choice(["parent", "point", "orient", "scale", "aim", "polevector"]))),
        *("--child", n.node(r), "--driver", n.node(r), "--driver", n.node(r)),
        *(["--aim-axis", "x", "--up-axis", "y"] if kind == "aim" else []),
        *(["--limb", *n.chain] if kind == "polevector" else []),
        *r.choice([[], ["--skip", "tx,rz"], ["--no-maintain-offset"], ["--vrm-constraints"]]),
    ],
    "add-posereader": lambda n, r: [
        *("--driver", n.node(r), "--target", r.choice(["rest", "up=0,1,0", n.moment(r), n.node(r)])),
        *r.choice([[], ["--reader", "cone", "--outer", "60"], ["--reader", "rbf"], ["--frame", "world"]]),
    ],
    "add-rivet": lambda n, r: [
        *("--mesh", r.choice([*n.meshes, n.node(r)])),
        *r.choice([["--triangle", "0"], ["--at", "0,1,0"], ["--vertex", "1"]]),
    ],
    "mirror": lambda n, r: r.choice(
        [
            [],
            [],
            ["--from-side", "right"],
            ["--mode", "orientation"],
            ["--mode", "blender"],
            ["--on-nonuniform-scale", "split"],
            ["--check"],
            ["--plane-at", "0"],
        ]
    ),
    "bake": lambda n, r: r.choice(
        [["--to", "joints"], ["--to", "controls"], ["--fps", "10"], ["--rig", "SAME"], ["--stretch"]]
    ),
    "take-clips": lambda n, r: ["--from", "SAME"],
    "pose": lambda n, r: ["--at", n.moment(r), *r.choice([[], ["--no-evaluate"]])],
    "snap": lambda n, r: [
        *("--to", r.choice(["ik", "fk"]), "--at", n.moment(r)),
        *r.choice([["--limbs", "auto"], ["--limb", *n.chain]]),
    ],
    "strip": lambda n, r: r.choice([[], [], ["--splits"]]),
    "make-limb": lambda n, r: [
        *r.choice(
            [["--locators", *n.chain], ["--points", "0,0,0", "1,0,0.1", "2,0,0", "--parent", n.node(r)]]
        ),
        *r.choice([[], ["--side", "left"], ["--no-skin"], ["--as", "joint"]]),
    ],
    "auto": lambda n, r: r.choice([[], ["--no-spec"]]),
    "draw": lambda n, r: r.choice([[], ["--view", "front"], ["--at", n.moment(r)]]),
    "view": lambda n, r: [],
    "export-blender": lambda n, r: [],
    "explain": lambda n, r: ["--limb", n.chain[1]],
    "recognise": lambda n, r: r.choice([[], ["--joints"], ["--json"]]),
}
