"""A spec to start from: what was recognised in a character."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from rigtri.evaluation.zero_pose import idle_ik
from rigtri.files.input_stream import opened, title
from rigtri.formats import ReadOptions, read
from rigtri.frames.skeleton import Skeleton, skeleton
from rigtri.model.arguments import typed
from rigtri.model.characters import characters
from rigtri.model.dataclass import dataclass
from rigtri.model.limb import Limb
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_twist.split_weights import twists_skin
from rigtri.operations.foot_roll import rolling_toes
from rigtri.recognition.layout import CONFIDENT, Chain, Character, Layout, Part
from rigtri.recognition.layout_output import direction_text
from rigtri.recognition.limbs import recognise as recognised_limbs
from rigtri.recognition.recognise import recognise
from rigtri.report import Report
from rigtri.text import a, and_more

# So many joints are shown as a comment; inspect shows all.
MOST_SHOWN = 200
# Twist joints of a bone; and the joints that a vertex has at most, as many as all engines show.
TWISTS, INFLUENCES = 2, 4
# The kinds of chains that are moved by their ends.
REACHING = ("arm", "leg", "limb")


@typed
def spec_init(path: Path | str, *, options: ReadOptions | None = None, report: Report | None = None) -> str:
    """A spec in YAML to start from, with steps for the joints of a file, as `rigtri spec-init` writes it.

    path: the file; options: how it is read; report: gets what else was read. Raises FileError where that
    cannot be, or where no joints are.
    """
    options = options or ReadOptions()
    with opened(path) as file:
        document = read(file, options)
        if report is not None:
            report.sources += document.needed()
        return starter(document.rig, title(path), options=options)


def starter(
    rig: Rig,
    file: str,
    layout: Layout | None = None,
    *,
    preset: str = "",
    open_places: bool = False,
    fixed_weights: str = "",
    options: ReadOptions | None = None,
    character: str | None = None,
) -> str:
    """A spec in YAML for ``rig``, with its joints as a comment; what is uncertain is commented out.

    layout: what was recognised in it, if that is known already. preset: of its axes. open_places: what is
    uncertain stands in it as null, which `build` refuses until a joint is named there. fixed_weights: why
    skin weights cannot be split, so that twist joints are left out. options: how the file was read.
    character: what the one of several is called whose steps these are; ``rig`` is as an edit of it alone sees
    it. Raises FileError for a file without joints.
    """
    options = options or ReadOptions()
    tree = skeleton(rig, options.root)
    layout = recognise(rig) if layout is None else layout
    toes = rolling_toes(tree, recognised_limbs(rig))
    limbs = _Limbs(rig, layout, open_places, tree, fixed_weights, toes, character)
    lines = [
        f"# A rig spec to start from, for {_quoted(file)}.",
        *(f"# {_visible(line)}" for line in recognised_lines(rig, layout)),
        "# Steps and options are those of the commands: rigtri COMMAND --help.",
        "# Editors check and complete it with the schema: rigtri schema spec > spec.schema.json",
        "version: 1",
        *_reading(options),
        "",
        "steps:",
        "  # New axes for all joints that carry weight; nothing that can be seen moves. Other presets:",
        "  # maya, unreal-editor, mgear, cmt, blender, rigify, talk, article, openxr, three-ik, vrm.",
        *limbs.step("orient-joints"),
        f"    preset: {preset or ('vrm' if rig.rules.orient_locked else 'article')}",
        *limbs.steps(),
        *_fingers(rig, layout),
        *_joints(rig, tree),
    ]
    return "\n".join(lines).rstrip() + "\n"


def _reading(options: ReadOptions) -> Iterator[str]:
    """How the file was read, where that was given."""
    if options.root is not None:
        yield f"root: {_quoted(options.root)}"
    if options.lenient:
        yield "lenient: true"
    if options.allow_external_paths:
        yield "allow-external-paths: true"
    if options.allow_missing:
        yield "allow-missing: true"


def plain_values(text: str) -> Any:
    """A spec in YAML as plain values, without its comments."""
    from ruamel.yaml import YAML

    return YAML(typ="safe", pure=True).load(text)


def recognised_lines(rig: Rig, layout: Layout) -> Iterator[str]:
    """What was recognised, a line for each character, and for what was not."""
    for one in layout.characters:
        faces = f" that faces {direction_text(one.facing)}" if any(one.facing) else ""
        limbs = ", ".join(chain.name for chain in one.limbs if chain.is_sure)
        yield f"{one.form}{faces}: {limbs or 'no limb that bends'}"
    if further := [f"{chain.name} ({chain.confidence:.2f})" for chain in left_out(layout)]:
        yield f"not sure, and left out: {', '.join(further)}"
    count = len(layout.characters)
    if count > 1 and len(characters(rig)) < count:  # add-controls goes by skins
        each = f"a root control for each of the {count} characters"
        yield f"left out: {each}; add-controls puts one over all of them"
    yield from layout.remarks


def unsure(layout: Layout) -> list[Chain]:
    """The limbs that may be such, but that nobody should act upon before they are named.

    Further ones of a character whose arms and legs are sure are `left_out`: skirts, wings, doubled bones.
    """
    return [chain for one in layout.characters for chain in _doubtful(one) if not _is_whole(one)]


def left_out(layout: Layout) -> list[Chain]:
    """The limbs that are not sure beside arms and legs that are: nobody needs to name them."""
    return [chain for one in layout.characters for chain in _doubtful(one) if _is_whole(one)]


def _doubtful(character: Character) -> list[Chain]:
    return [chain for chain in character.limbs if chain.kind in REACHING and not chain.is_sure]


def _is_whole(character: Character) -> bool:
    """Whether each arm and leg of two sides is sure, or there is a sure one of its kind and side."""
    limbs = [chain for chain in character.limbs if chain.kind in ("arm", "leg")]
    sure = [chain for chain in limbs if chain.is_sure]
    places = {(chain.kind, chain.side) for chain in sure}
    pairs = {("arm", "left"), ("arm", "right"), ("leg", "left"), ("leg", "right")}
    return bool(sure) and (pairs <= places or len(sure) == len(limbs))


def _reaching(layout: Layout) -> list[Chain]:
    """The chains that bend and are moved by their ends; wings and tails are moved joint by joint."""
    return [chain for chain in layout.chains if chain.bend and chain.kind in REACHING]


@dataclass(frozen=True)
class _Limbs:
    """The steps for limbs. open_places: limbs that are not sure stand in them as null.

    fixed_weights: why the file's skin weights cannot be split; "" where they can. toes: as `rolling_toes`
    has them. character: of several in the file, the only one that is edited.
    """

    rig: Rig
    layout: Layout
    open_places: bool
    tree: Skeleton
    fixed_weights: str
    toes: Mapping[Limb, int | str]
    character: str | None

    def step(self, name: str) -> Iterator[str]:
        """The first lines of a step."""
        yield f"  - do: {name}"
        if self.character is not None:
            yield f"    character: {_quoted(self.character)}"

    @property
    def rolls(self) -> bool:
        """Whether there is a foot that can roll."""
        return any(isinstance(toe, int) for toe in self.toes.values())

    def steps(self) -> Iterator[str]:
        """All lines behind the preset of orient-joints."""
        open_limbs = unsure(self.layout) if self.open_places else []
        every = [chain for chain in _reaching(self.layout) if chain.is_sure]
        idle = [idle_ik(self.rig, _triple(chain), self.tree.carries) for chain in every]
        sure = [chain for chain, why in zip(every, idle, strict=True) if not why]
        for chain, why in zip(every, idle, strict=True):
            if why:
                yield f"    # No IK for the {chain.name}: {_visible(why)}."
        if sure or open_limbs:
            if lacking := self._lacking([*sure, *open_limbs]):
                words = ", ".join(lacking)
                yield f"    # Not recognised, so not here: {words}. Name three joints of each."
            yield "    limb: &limbs"
            yield from (self._row(self._names(chain), chain) for chain in sure)
            yield from (self._row("null, null, null", chain) for chain in open_limbs)
            yield from self._left_out()
        yield ""
        if not self.layout.characters:
            yield "  # No arms or legs were recognised. Name three joints of a limb:"
            yield "  # - do: add-polevector"
            yield "  #   limb: [upper_arm, forearm, hand]"
            yield "  # - do: add-controls"
            yield "  #   ik: [upper_arm, forearm, hand]"
            yield ""
            return
        yield from self._twist(sure)
        yield from self._controls(bool(sure or open_limbs))

    def _row(self, names: str, chain: Chain) -> str:
        """A limb as an item of a list, with what it is."""
        words = f"{chain.name}, {chain.confidence:.2f}"
        if not chain.is_sure:
            words += f"; name its three joints, perhaps {self._names(chain)}, or remove this line"
        return f"      - [{names}]  # {words}"

    def _left_out(self) -> Iterator[str]:
        """What is neither sure nor to be named, as comments."""
        for chain in [*left_out(self.layout), *([] if self.open_places else unsure(self.layout))]:
            words = f"perhaps {a(chain.name)}, {chain.confidence:.2f}: left out"
            yield f"      # - [{self._names(chain)}]  # {words}"

    def _names(self, chain: Chain) -> str:
        return _names(self.rig, chain.bend)

    def _wants_twist(self, chain: Chain) -> bool:
        """Whether it is an arm or leg without twist joints: those that rigtri has added stay as they are."""
        start, middle, end = chain.bend
        made = {record.joint for record in self.rig.records(TwistRecord).values()}
        if made.intersection(map(self.rig.address, (start, middle))):
            return False
        along = [node for node in self.rig.below(start) if not self.rig.is_below(node, end)]
        twists = {part.joint for one in self.layout.characters for part in one.parts if part.role == "twist"}
        return chain.kind in ("arm", "leg") and not twists.intersection(along)

    def _twisting(self, chain: Chain) -> str:
        """The bones of a limb whose twist joints get weight: ``both``, ``upper``, ``lower``, or "" for none.

        The lower bone of a flat rig ends in a joint that does not follow it.
        """
        rig, (start, middle, end) = self.rig, chain.bend
        takes = partial(twists_skin, rig, count=TWISTS, most=INFLUENCES)
        upper = takes(start, middle, upper=True)
        lower = rig.is_below(end, middle) and takes(middle, end, upper=False)
        return "both" if upper and lower else "upper" if upper else "lower" if lower else ""

    def _twist(self, sure: list[Chain]) -> Iterator[str]:
        limbs = [chain for chain in sure if self._wants_twist(chain)]
        if limbs and self.fixed_weights:
            yield f"  # Left out: twist joints, which would get no weight. {_visible(self.fixed_weights)}"
            yield ""
            return
        groups: dict[str, list[Chain]] = {}
        for chain in limbs:
            groups.setdefault(self._twisting(chain), []).append(chain)
        for which in ("both", "upper", "lower"):
            if which in groups:
                yield "  # Twist joints with weight of the skin, which avoid the candy-wrapper effect on"
                yield "  # these limbs."
                yield from self.step("add-twist")
                yield "    limb:"
                yield from (f"      - [{self._names(chain)}]" for chain in groups[which])
                if which != "both":
                    yield f"    {which}: true"
                yield f"    count: {TWISTS}"
                yield "    split-weights: true"
                yield f"    max-influences: {INFLUENCES}"
                yield ""
        for chain in groups.get("", []):
            yield f"  # Left out: twist joints, as no vertex lies along the bones of [{self._names(chain)}]"
            yield ""

    def _lacking(self, known: list[Chain]) -> list[str]:
        """The arms and legs of a character that are not among those that are known, where it has sides."""
        found = {(chain.kind, chain.side) for chain in known}
        return [
            f"{side} {kind}"
            for kind in ("arm", "leg")
            for side in ("left", "right")
            if (kind, side) not in found and (kind, "") not in found
        ]

    def _controls(self, has_limbs: bool) -> Iterator[str]:
        yield "  # A root control, an FK control for each joint, IK ends and pole vectors for these limbs."
        yield from self.step("add-controls")
        yield "    whole-character: true"
        if has_limbs:
            yield "    ik: *limbs"
        if self.rolls:
            yield "    # Pivots at heel, toe tip and ball of each foot, below its IK end."
            yield "    foot-roll: true"
        for why in {} if self.rolls else dict.fromkeys(self.toes.values()):
            feet = [f"'{self.rig.title(limb.end)}'" for limb, toe in self.toes.items() if toe == why]
            yield f"    # No foot-roll for {_visible(and_more(feet))}: {why}."
        if left := [part.joint for part in self._followers()]:
            yield f"    exclude: [{_names(self.rig, left)}]"
        yield ""
        yield "  # The motion of the clips on the controls too, for animators."
        yield from (f"  # {line[2:]}" for line in (*self.step("bake"), "    to: controls"))
        yield ""

    def _followers(self) -> Iterator[Part]:
        """Joints that follow the bones by themselves; a control would only be in the way.

        A root follows nothing, and the root control carries it by its own control.
        """
        for one in self.layout.characters:
            for part in one.parts:
                follows = part.role in ("twist", "helper") and part.joint not in self.tree.roots
                if follows and part.confidence >= CONFIDENT:
                    yield part


def _triple(chain: Chain) -> tuple[int, int, int]:
    start, middle, end = chain.bend
    return start, middle, end


def _names(rig: Rig, nodes: Iterable[int]) -> str:
    return ", ".join(_name(rig, node) for node in nodes)


def _name(rig: Rig, node: int) -> str:
    """What finds a node, as YAML has it."""
    # Of one character of several, names mean its own joints.
    ways = (rig.names[node], rig.address(node), rig.path(node), rig.labels[node])
    return _quoted(next((way for way in ways if _plain(way) and rig.known(way) == node), rig.labels[node]))


def _plain(way: str) -> bool:
    """Whether a node's name or path means nothing else in a spec: no braces, no index, no bone of VRM."""
    return "{" not in way and not way.startswith(("#", "vrm:"))


def _quoted(text: str) -> str:
    """A text as YAML has it in quotes, what would end a line or cannot be seen as an escape."""
    return _visible(json.dumps(text, ensure_ascii=False))


def _visible(words: str) -> str:
    return "".join(letter if letter.isprintable() else _escape(ord(letter)) for letter in words)


def _escape(code: int) -> str:
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _fingers(rig: Rig, layout: Layout) -> Iterator[str]:
    """Controls for a few joints, as an example."""
    chains = [c for c in layout.chains if c.kind == "finger" and c.is_sure and len(c.joints) > 1]
    if not chains:
        return
    yield "  # Fingers alone, with shapes of their own."
    yield "  # - do: add-controls"
    yield "  #   chain:"
    yield from (f"  #     - [{_names(rig, (chain.joints[0], chain.joints[-1]))}]" for chain in chains)
    yield "  #   shape: {fk: square}"
    yield ""


def _joints(rig: Rig, tree: Skeleton) -> Iterator[str]:
    yield "# The joints, named as in steps:"
    waiting = [(top, 0) for top in reversed(tree.roots)]
    for _ in range(min(MOST_SHOWN, len(tree.joints))):
        joint, depth = waiting.pop()
        yield f"#   {'  ' * depth}{_name(rig, joint)}"
        waiting += [(child, depth + 1) for child in reversed(tree.below[joint])]
    if waiting:
        yield f"#   … {len(tree.joints) - MOST_SHOWN} more; all with: rigtri inspect FILE"
