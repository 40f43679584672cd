"""Make the sample files, or check that they are what this script makes.

    python samples/make.py            writes them beside this script
    python samples/make.py --check    exits with 1 when one of them differs

The same bytes on every machine: rigtri's own arithmetic, fixed dates, no clock.
"""

from __future__ import annotations

import sys
from pathlib import Path

import figures
import write_gltf
import write_usd

HERE = Path(__file__).parent


def samples() -> dict[str, bytes]:
    """The bytes of every sample, by file name."""
    made = {"arm.gltf": write_gltf.gltf_embedded(figures.arm())}
    made["arm.usda"] = write_usd.usda(figures.arm(), clip="reach")
    made["biped.gltf"], made["biped.bin"] = write_gltf.gltf_with_bin(figures.biped())
    made["biped.usda"] = write_usd.usda(figures.biped(), clip="walk")
    made["biped.usdz"] = write_usd.usdz(made["biped.usda"], "biped.usda")
    for figure in figures.ALL[1:]:
        made[f"{figure.__name__}.glb"] = write_gltf.glb(figure())
    return made


def main(arguments: list[str]) -> int:
    different = []
    for name, content in samples().items():
        path = HERE / name
        if arguments == ["--check"]:
            if not path.exists() or path.read_bytes() != content:
                different.append(name)
        else:
            path.write_bytes(content)
            print(f"{name}: {len(content)} bytes")
    if different:
        print(f"not what samples/make.py makes: {', '.join(different)}", file=sys.stderr)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
