"""A USD file: read into a rig, and written again with only what changed in it."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import NameNotFoundError
from rigtri.files.atomic_write import same_file
from rigtri.files.freed_memory import give_back
from rigtri.formats.document import Companion, Embedded, ReadOptions
from rigtri.formats.usd.codeless_schemas import check_known
from rigtri.formats.usd.composition import external_paths
from rigtri.formats.usd.composition.edit_target import sublayer
from rigtri.formats.usd.composition.held_layers import Held, files_of, reading
from rigtri.formats.usd.composition.stage import one_thread, open_file, quiet
from rigtri.formats.usd.composition.variant_choices import VariantSet, alike, lacking, selecting
from rigtri.formats.usd.composition.variant_combinations import combinations
from rigtri.formats.usd.composition.variants import in_words
from rigtri.formats.usd.embed import embedded
from rigtri.formats.usd.layer_writer import Output
from rigtri.formats.usd.opinions.instance_edits import instance_of
from rigtri.formats.usd.reading.control_shape_reader import read_lines
from rigtri.formats.usd.reading.metadata_attributes import elsewhere, overlaid
from rigtri.formats.usd.reading.reader import read_source
from rigtri.formats.usd.reading.scene_facts import read_scene_facts
from rigtri.formats.usd.reading.source import (
    Source,
    blocked_samples,
    played_by_instances,
    read_meshes,
)
from rigtri.formats.usd.run_passes import edit_stage
from rigtri.model.content import Content
from rigtri.model.control_shapes import Lines
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.scene_facts import SceneFacts
from rigtri.report import Notice

# More variants than these are not even counted.
MOST_CHOICES = 256


class _Drawn:
    """The meshes and lines of a stage, read when they are first asked for; lets go of it as documents do."""

    def __init__(self, source: Source, notices: list[Notice]) -> None:
        self._source, self._notices = source, notices
        self._files = files_of(source.stage)
        self._meshes: Sequence[Mesh] | None = None

    def __del__(self) -> None:
        with one_thread:
            self.__dict__.clear()

    def __call__(self) -> Sequence[Mesh]:
        with one_thread:
            if self._meshes is None:
                with reading(self._files):
                    self._meshes = read_meshes(self._source, self._notices)
            return self._meshes

    def lines(self, key: Hashable) -> Lines | None:
        with one_thread:
            return read_lines(self._source.stage, key)


class UsdDocument:
    """A .usd, .usda, .usdc or .usdz file. Edits are opinions of its root layer."""

    def __init__(self, source: Source, options: ReadOptions, layer: Any) -> None:
        """layer: the one to edit; the stage's root layer, or the opinions above the file they are for."""
        self._notices = list(source.warnings)
        # Of the source alone: a rig that held its document would keep the stage open in a ring.
        self._drawn = _Drawn(source, self._notices)
        rig = replace(source.rig, content=Content(self._drawn.lines, self._drawn, self._drawn))
        if rig.metadata and not options.is_override:
            others = elsewhere(source.stage, rig, layer)
            both = overlaid(source.stage, rig, layer) if others else frozenset[int]()
            rig = replace(rig, rules=replace(rig.rules, elsewhere=others, overlaid=both))
        self._source, self._options = replace(source, rig=rig), options
        self._held = Held(source.stage)
        self._output = Output(self._source, layer, options, self._held.content)
        self._hidden: dict[str, list[str]] = {}

    def __del__(self) -> None:
        with one_thread:  # which goes through all stages where it reads a layer anew
            self.__dict__.clear()

    @classmethod
    def read(
        cls,
        path: Path,
        options: ReadOptions | None = None,
        opened: tuple[Any, Any, Sequence[Notice]] | None = None,
    ) -> UsdDocument:
        """Read a file. FileError for what is damaged, breaks UsdSkel's rules or has no skeleton.

        opened: what `open_file` gave for it, with these options.
        """
        options = options or ReadOptions()
        with quiet(f"{path}: USD cannot read it"):
            stage, layer, warnings = opened or open_file(
                path, allow_external=options.allow_external_paths, allow_missing=options.allow_missing
            )
            if options.edit_target != "root" and not options.is_override:
                layer = sublayer(stage, options.edit_target)
            with reading(files_of(stage)):
                document = cls(read_source(path, options, stage, warnings), options, layer)
        check_known()  # it warns, which nobody would see within
        return document

    @property
    def rig(self) -> Rig:
        return self._source.rig

    @property
    def source(self) -> Source:
        """The stage, and what of it the nodes, skins and clips of the rig are."""
        return self._source

    @property
    def warnings(self) -> Sequence[Notice]:
        """What the reader noticed; after `write`, also what the writer had to do."""
        return tuple(self._notices)

    @property
    def hidden(self) -> Mapping[str, Sequence[str]]:
        """By layer, the attributes whose opinions there are hidden by what `write` wrote."""
        return self._hidden

    def meshes(self) -> Sequence[Mesh]:
        """Skinned and rigid points, blend shapes as morphs without inbetweens."""
        return self._drawn()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        """The same: USD keeps what is drawn in memory anyway."""
        return self.meshes()

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        """Units and range of the stage; visibility, lenses, lights and materials of what it shows."""
        shown = {node: self.rig.labels[node] for node in np.flatnonzero(self.rig.attachment >= 0).tolist()}
        with quiet(f"{self._source.path}: USD cannot read what it shows"):
            facts = read_scene_facts(self._source.stage, shown, closely=closely)
            blocked = {f"blocked times of {at}": times for at, times in blocked_samples(self._source).items()}
            return replace(facts, whole={**facts.whole, **blocked}, own=played_by_instances(self._source))

    def write(self, rig: Rig, part: Path, target: Path) -> Sequence[Companion]:
        """Write the file, or only the opinions for an override; see `formats.Document`.

        Relative asset paths are anchored anew where ``target`` lies in another folder.
        UsageError for a target of another format; FileError where the source was replaced since.
        """
        output, stage = self._output, self._source.stage
        stays = output.is_new_layer or output.is_sublayer
        with quiet(f"{target}: USD cannot write it"):
            with quiet(f"{self._source.path} was replaced, and USD cannot read it"):
                self._held.check((self._source.layer, output.layer), stays=stays)
            output.check_target(target)
            output.check_metrics(rig)
            edit = edit_stage(self._source, rig, self._options)
            output.write(edit.edits, part, target, edit.notices, strips=edit.rig.pending.strips)
            self._hidden = output.hidden(edit.edits)
            routed = {*map(id, edit.opinions)} != {*map(id, edit.values)}
            prims = {value.prim for value in edit.values}
            inside = any(instance_of(stage, prim) is not None for prim in prims)
            if routed or inside or output.is_sublayer or edit.expected:
                values = [*edit.prepared, *edit.values]
                edit.expected.check(output.composed(part)[0], values, edit.staying, output.as_composed)
        self._notices += [notice for notice in edit.notices if notice not in self._notices]
        return ()

    def choices(self) -> Sequence[Mapping[VariantSet, str]]:
        """Each way to select one variant otherwise than the file, and sets that only that one shows; then
        several of them at once that each show characters otherwise.

        Of the instances of one prototype, at the first alone.
        """
        source = self._source
        with quiet(f"{source.path}: USD cannot read its variants"):
            return list(islice(combinations(source.stage, alike(source.stage)), MOST_CHOICES))

    def selecting(self, chosen: Mapping[VariantSet, str]) -> UsdDocument | None:
        """The file with these variants; None if it lacks the sets. NameNotFoundError for a variant."""
        source = self._source
        with quiet(f"{source.path}: USD cannot read its variants"):
            gone = lacking(source.stage, chosen)
            if gone:
                if gone == "set":
                    return None
                raise NameNotFoundError("variant", in_words(chosen), ())
            stage = selecting(source.stage, chosen)
        options = replace(self._options, empty=True)
        read = read_source(source.path, options, stage, one_state=True)
        return UsdDocument(read, options, stage.GetRootLayer())

    def sharing(self, other: UsdDocument) -> UsdDocument:
        """The file with an instance read in place of others where that is so in another file, too.

        Prototypes are split by their last bits, or by what edits wrote, and joined by a variant.
        """
        source, twins = self._source, other.source.instances.twins()
        if source.instances.twins() == twins:
            return self
        read = read_source(source.path, self._options, source.stage, one_state=source.one_state, twins=twins)
        return UsdDocument(read, self._options, source.layer)

    def image(self, asset: Any) -> bytes:
        """The bytes of the texture that an asset path names. FileError where they are not to be had."""
        allowed = self._options.allow_external_paths
        return external_paths.texture(asset, self._source.path, allow_external=allowed)

    def embedded(self) -> Embedded:
        """All layers as one, with the textures of its materials."""
        source = self._source
        with quiet(f"{source.path}: USD cannot make one layer of it"):
            return embedded(source.stage, source.path, self.image)

    def needed(self) -> Iterator[tuple[Path, str]]:
        """Layers and assets of all variants; of an override also what it is for."""
        source = self._source
        if self._output.is_new_layer:
            yield source.path, "the file that the override is for"
        with quiet(f"{source.path}: USD cannot read what it refers to"):
            files = list(external_paths.files(source.stage, source.path))
        # To edit a file in place is no loss, whoever refers to it.
        yield from (entry for entry in files if not same_file(entry[0], self._output.layer_path))

    def reopen(self, part: Path) -> UsdDocument:
        """Read what was written; bare opinions are read over the file they were made for."""
        give_back()  # what writing took in small pieces, before all is read again
        whole = not (self._output.is_bare or self._output.is_sublayer)
        options = replace(self._options, empty=True)  # its only skeleton may have been removed
        if whole and (not self._output.is_streamed or part.suffix.lower() == ".usdz"):
            # Where the output lies in another folder, the source's files are outside it, but were allowed.
            return UsdDocument.read(part, replace(options, allow_external_paths=True))
        with quiet(f"{part}: USD cannot read it"):
            stage, layer = self._output.composed(part)
        return UsdDocument(read_source(part, options, stage), options, layer)
