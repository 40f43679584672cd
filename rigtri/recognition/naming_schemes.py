"""Naming schemes: which words of a name mean which bone, one small TOML file for each scheme.

A scheme has a ``title``; ``marks``, words that occur in its names alone; and two tables, ``middle`` and
``sides``, from bones of the VRM 1.0 humanoid (without ``left`` and ``right``) to the words that mean them:
lower case, without spaces and marks, several apart by spaces. ``like`` takes over the tables of another.
``chains`` are words of joints that are only numbered, ``left`` and ``right`` further words of sides.
``write`` says how its names are written (`rigtri.recognition.written_names`); a scheme like another without
marks is there only to be written. A user's own files (`own_schemes`) go before ours; that of other languages
than English is only read.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, Literal, get_args

from rigtri.errors import FileError, did_you_mean, system_reason
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import SIDES, Side
from rigtri.recognition.layout import BENDS, FINGERS, MIDDLE, SIDED, LimbKind
from rigtri.recognition.limb_words import LONGEST, limb_words
from rigtri.recognition.name_parsing import ParsedName, parse_name, with_words
from rigtri.recognition.word_tables import our_table, role_words

# The environment variable that names folders with schemes of one's own, apart by os.pathsep.
FOLDERS = "RIGTRI_SCHEMES"
# Names that are kept, read: those of a few characters, not of all files of a batch.
_NAMES = 1 << 15
# Ours that fit anything are tried last.
_LAST = ("bones", "joints")
# What roles.toml has for joints beside the bones of a body.
BESIDE = frozenset(["twist", "end", "control", "attachment", "helper"])
# What it has for joints that are no part of an arm or leg.
NO_LIMB = frozenset(["control", "attachment", "tail", "wing", "ear", "feeler", "machine"])
# What it has for chains of joints instead of single ones.
_CHAINS = frozenset(["tail", "wing", "ear", "feeler", "machine", "face", "muzzle", "skull", "trunk"])
# What parts of a bone are called after its name: ``ElbowPart1_R``. Source: Advanced Skeleton.
PARTS = ("part", "segment", "seg")
# So many bones at least a character has that Rigify has made.
_BONES = 8
_TABLES = {"middle": MIDDLE, "sides": SIDED, "chains": tuple(BENDS)}
# Chains that may have more joints than bones, by the bones that these are.
LONG: Mapping[str, tuple[str, ...]] = {"Spine": ("spine", "chest", "upperChest"), "Neck": ("neck",)}
# What conform asks of a skeleton besides names.
_SKELETON = ("pose", "axes", "root")
_TEXTS = ("title", "marks", "like", "left", "right")
_TO_DO = "give a text in quotes, several words apart by spaces"


@dataclass(frozen=True)
class Scheme:
    """title; marks; middle, sides: bone by words; chains: kind by words; source: where it was read.

    own_sides: sides by words that only this scheme takes for such.
    """

    title: str
    marks: frozenset[str]
    middle: Mapping[str, str]
    sides: Mapping[str, str]
    chains: Mapping[str, str]
    source: str
    own_sides: Mapping[str, Side]

    def read(self, parsed: ParsedName) -> ParsedName:
        """A name as this scheme has it: a word of its own for a side is none of the bone."""
        own = [word for word in parsed.kept if word in self.own_sides]
        if len(own) != 1 or parsed.side or len(parsed.kept) < 2:
            return parsed
        kept = tuple(word for word in parsed.kept if word not in self.own_sides)
        return with_words(self.own_sides[own[0]], kept, parsed.words)

    @property
    def is_common(self) -> bool:
        """Whether it is nobody's, but words that many use."""
        return self.source in _LAST

    def bone(self, parsed: ParsedName) -> tuple[str, bool]:
        """The bone of a name without its side, and whether its number counted; "" where it has none."""
        for table in (self.sides, self.middle):
            for key in (parsed.raw, parsed.key):
                if key in table:
                    return table[key], True
        for table in (self.sides, self.middle):
            if parsed.plain in table:
                return table[parsed.plain], parsed.plain == parsed.key
        return "", False


def schemes(own: Sequence[Scheme] = ()) -> tuple[Scheme, ...]:
    """All schemes, in the order in which they are tried: given ones, those of `FOLDERS`, ours."""
    return (*own, *_found(os.environ.get(FOLDERS, "")), *_ours())


@cache
def _ours() -> tuple[Scheme, ...]:
    tables = _tables().items()
    read = [k for k, table in tables if "marks" in table or "like" not in table or k in _LAST]
    order = sorted(read, key=lambda name: (_LAST.index(name) + 1 if name in _LAST else 0, name))
    found = [_scheme(_tables()[name], name) for name in order]
    other = our_table(Path(__file__).with_name("languages.toml"))
    return (*found[: -len(_LAST)], _scheme(other, "languages"), *found[-len(_LAST) :])


@cache
def _tables() -> Mapping[str, Mapping[str, Any]]:
    """Our schemes as their files have them, by name."""
    found = Path(__file__).with_name("schemes").glob("*.toml")
    return {file.stem: our_table(file) for file in found}


@cache
def _found(folders: str) -> tuple[Scheme, ...]:
    named = [Path(folder) for folder in folders.split(os.pathsep) if folder]
    for folder in named:
        if not folder.is_dir():
            raise FileError(f"{FOLDERS} names {folder}, which is not a folder: create it, or name another")
    return own_schemes([path for folder in named for path in sorted(folder.glob("*.toml"))])


def own_schemes(paths: Sequence[Path | str | Scheme]) -> tuple[Scheme, ...]:
    """`own_scheme` of each file. Raises FileError with all that is wrong in any of them; TypeError."""
    if isinstance(paths, str | Path | Scheme):
        paths = [paths]
    if not isinstance(paths, Sequence) or not all(isinstance(one, str | Path | Scheme) for one in paths):
        raise TypeError(f"scheme must be a list of naming schemes or their files, not {paths!r}")
    found, wrong = [], []
    for path in paths:
        try:
            found.append(path if isinstance(path, Scheme) else own_scheme(Path(path)))
        except FileError as error:
            wrong.append(str(error))
    if wrong:
        raise FileError("; ".join(wrong))
    return tuple(found)


def scheme_tables() -> Mapping[str, Mapping[str, Any]]:
    """Our schemes as their files have them, by name, those that are only written among them."""
    return _tables()


def own_scheme(path: Path) -> Scheme:
    """A scheme of one's own from a file. Raises FileError, with all that is wrong, where it is none."""
    return _scheme(own_table(path), str(path))


def own_table(
    path: Path, more: Callable[[Mapping[str, Any]], Iterable[str]] = lambda table: ()
) -> Mapping[str, Any]:
    """The tables of a scheme of one's own. Raises FileError, with all that is wrong, where it is none.

    more: further faults of the table.
    """
    import tomllib  # `our_table` reads ours

    try:
        if not path.is_file():
            raise FileError(f"{path} is not a naming scheme: it does not exist or is not a regular file")
        table = tomllib.loads(path.read_text("utf-8-sig"))
    except OSError as error:
        raise FileError(f"{path} cannot be read: {system_reason(error)}") from error
    except UnicodeDecodeError as error:
        raise FileError(f"{path} is not a naming scheme: it is not UTF-8 at offset {error.start}") from error
    except (ValueError, RecursionError) as error:  # of TOML, too many digits, lists in lists
        raise FileError(f"{path} is not a naming scheme: this is not TOML: {error}") from error
    if found := [*_faults(table), *more(table)]:
        raise FileError(f"{path} is not a naming scheme: {'; '.join(found)}. Example: docs/recognise.md")
    return table


def _read(part: str, word: str) -> tuple[bool, str]:
    """Whether a name can say a word of a table (or of ``marks``), and how the word would be written."""
    read = parse_name(word)
    if part == "chains":
        return word == read.plain, read.plain
    if part == "marks":
        return word in (read.key, read.plain, *read.words), read.key
    return word in (read.raw, read.key), read.raw


def _scheme(table: Mapping[str, Any], source: str) -> Scheme:
    base = _tables()[table["like"]] if "like" in table else {}
    parts = {part: {**base.get(part, {}), **table.get(part, {})} for part in ("middle", "sides", "chains")}
    parts["middle"].setdefault("jaw", _tables()["bones"]["middle"]["jaw"])  # which makers leave out
    middle, sides, chains = (_turned(parts[part]) for part in ("middle", "sides", "chains"))
    marks = frozenset(table.get("marks", "").split())
    own: dict[str, Side] = {word: each for each in get_args(Side) for word in table.get(each, "").split()}
    return Scheme(table["title"], marks, middle, sides, chains, source, own)


def _turned(table: Mapping[str, str]) -> dict[str, str]:
    """From words to what they mean; the first that has a word keeps it."""
    found: dict[str, str] = {}
    for bone, names in table.items():
        for name in names.split():
            found.setdefault(name, bone)
    return found


@lru_cache(_NAMES)
def limb_kind_in_name(name: str) -> LimbKind | Literal[""]:
    """The limb that a name says to be a part of, by words in common use.

    >>> limb_kind_in_name("LeftForeArm"), limb_kind_in_name("RKnee"), limb_kind_in_name("handIK.L")
    ('arm', 'leg', '')
    """
    found = (scheme.bone(parse_name(name))[0] for scheme in _ours() if scheme.is_common)
    bone = next((bone for bone in found if bone), "")
    return next((kind for kind, bones in BENDS.items() if bone in bones), "")


def is_bone(name: str) -> bool:
    """Whether any scheme has a bone of this name.

    >>> is_bone("LeftForeArm"), is_bone("LeftForeArm_grp")
    (True, False)
    """
    return any(scheme.bone(parse_name(name))[0] for scheme in schemes())


def are_marked(names: Sequence[str]) -> list[bool]:
    """Which names a rig calls ``DEF-``, as it does its bones that deform where controls stand beside them.

    None where there are only a few. Source: Blender manual, Rigify, "Bone naming".
    """
    marked = ["def" in parse_name(name).words for name in names]
    return marked if marked.count(True) >= _BONES else [False] * len(names)


def is_segment(name: str, above: str) -> bool:
    """Whether a name says that a joint is only a part of the bone above: a twist joint, or a numbered piece.

    >>> is_segment("DEF-forearm.L.001", "DEF-forearm.L"), is_segment("leg_02.L", "leg_01.L")
    (True, False)
    """
    parsed, over = parse_name(name), parse_name(above)
    if not parsed.side:
        return False
    levels = limb_words(name).levels
    bone = levels.keys() in ({"upper"}, {"lower"}) and 1.0 in levels.values()
    again = bone and (parsed.side, parsed.plain) == (over.side, over.plain) and parsed.raw != over.raw
    # ``Arm1.L.001`` below ``Arm1.L``; but ``Leg.L.001`` may be the shin below the thigh ``Leg.L``.
    more = over.key != over.plain and name.startswith(f"{above}.") and name[len(above) + 1 :].isdigit()
    part = parsed.side == over.side and parsed.plain in (over.plain + word for word in PARTS if over.plain)
    return again or more or part or "twist" in roles_in_name(name)


@lru_cache(_NAMES)
def roles_in_name(name: str) -> tuple[str, ...]:
    """The roles that a name says, ``twist``, ``control``, ``tail`` …, in the order of roles.toml.

    A word may end in that of a role; of chains only after a side, ``leftwing``: swings are no wings.
    """
    found = parse_name(name)
    ends = [
        (word[:k], word[k:])
        for word in found.words
        for k in range(max(1, len(word) - LONGEST), len(word) - 3)
    ]
    any_end, sided = {end for _, end in ends}, {end for before, end in ends if before in SIDES}
    return tuple(
        role
        for role, known in role_words().items()
        if found.words & known or found.plain in known or known & (sided if role in _CHAINS else any_end)
    )


def _faults(table: Mapping[str, Any]) -> Iterator[str]:
    """A line for each fault of a user's scheme: where, what, and what to do."""
    for key, value in table.items():
        if key in _TABLES:
            yield from _of_table(key, value)
        elif key == "write":
            yield from _of_written(value)
        elif key == "skeleton":
            yield from _of_skeleton(value)
        elif key not in _TEXTS:
            yield f"there is no '{key}'.{_near(key, (*_TEXTS, *_TABLES, 'write', 'skeleton'))}"
        elif not isinstance(value, str):
            yield f"'{key}' is {_kind(value)}: {_TO_DO}"
        elif key == "like" and value not in _tables():
            yield f"there is no scheme '{value}' to be like.{_near(value, sorted(_tables()))}"
        elif key == "marks":
            yield from _of_words("'marks'", "marks", value)
    if "title" not in table:
        yield "'title' is missing: give it one, which evidence will say"


def _of_table(name: str, value: object) -> Iterator[str]:
    if not isinstance(value, dict):
        yield f"'{name}' is {_kind(value)}: make it a table, [{name}] with a line for each bone"
        return
    taken: dict[str, str] = {}
    for bone, text in value.items():
        where = f"[{name}] {bone}"
        if bone not in _TABLES[name]:
            yield f"{where}: there is no such bone here.{_near(bone, _TABLES[name])}"
        if not isinstance(text, str):
            yield f"{where} is {_kind(text)}: {_TO_DO}"
        else:
            yield from _of_words(where, name, text)
            for word in text.split():
                if taken.setdefault(word, bone) != bone:
                    yield f"{where}: '{word}' means {taken[word]} already, and a word means one bone"


def _of_skeleton(value: object) -> Iterator[str]:
    if not isinstance(value, dict):
        yield f"'skeleton' is {_kind(value)}: make it a table, [skeleton] with {', '.join(_SKELETON)}"
        return
    for key, text in value.items():
        if key not in _SKELETON:
            yield f"[skeleton]: there is no '{key}'.{_near(key, _SKELETON)}"
        elif not isinstance(text, str):
            yield f"[skeleton] {key} is {_kind(text)}: {_TO_DO}"


def _of_written(value: object) -> Iterator[str]:
    if not isinstance(value, dict):
        yield f"'write' is {_kind(value)}: make it a table, [write] with a line for each bone"
        return
    for bone, text in value.items():
        if bone in (*FINGERS, *LONG):
            texts = isinstance(text, list) and all(isinstance(one, str) for one in text)
            if not texts or (bone in FINGERS and len(text) > 3):
                most = "up to three " if bone in FINGERS else ""
                yield f"[write] {bone} is {_kind(text)}: give a list of {most}names, root to tip"
        elif bone not in ("sided", *MIDDLE, *SIDED):
            known = ("sided", *MIDDLE, *SIDED, *FINGERS, *LONG)
            yield f"[write] {bone}: there is no such bone.{_near(bone, known)}"
        elif not isinstance(text, str) or not text:
            yield f"[write] {bone} is {_kind(text)}: give a name in quotes"
        elif bone == "sided" and "{name}" not in text:
            yield "[write] sided: it has no {name}, e.g. {name}_{s} or {Side}{name}"


def _of_words(where: str, table: str, text: str) -> Iterator[str]:
    for word in text.split():
        can_be, better = _read(table, word)
        if not can_be:
            hint = f"write '{better}'" if better else "sides and words like joint are ignored; leave it out"
            yield f"{where}: no name can say '{word}': {hint}"


def _near(word: str, known: Collection[str]) -> str:
    return did_you_mean(word, known) or f" There are {', '.join(known)}"


def _kind(value: object) -> str:
    """What a value of TOML is, in its terms."""
    kinds = {bool: "true or false", int: "a number", float: "a number", list: "a list", dict: "a table"}
    return "a text" if isinstance(value, str) else kinds.get(type(value), "a date")
