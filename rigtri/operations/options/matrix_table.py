"""The options of matrix_table."""

from __future__ import annotations

from rigtri.maths import RotateOrder
from rigtri.model.dataclass import dataclass
from rigtri.model.options import option
from rigtri.operations.option_kinds import Nodes
from rigtri.operations.options.constrain import JointOrient
from rigtri.operations.options.pose import PoseOptions


@dataclass(frozen=True)
class MatrixTableOptions(PoseOptions):
    """Options of matrix_table, and of the commands that print matrices."""

    joints: Nodes = option((), help="These nodes alone. [all]")
    rotate_order: RotateOrder = option("xyz", help="The order of the Euler angles.", rare=True)
    joint_orient: JointOrient = option(
        "rest",
        help="The joint orient of joints, as Maya has it: their rotation at rest, none, or degrees.",
        rare=True,
    )
