"""Weft's public C++ interface. Use the package weft, which explains it."""

from collections.abc import Callable, Sequence
from typing import Annotated, Any, Literal, overload

import numpy
from numpy.typing import NDArray


version: str = '0.1.0'

class InputError(ValueError):
    """
    Invalid input. The message is a full sentence: the error, its place, and the expected value.
    """

class Fabric:
    """
    A fabric in SI units, independent of the mesh; the defaults are those of cotton shirting.
    """

    def __init__(self, *, density: float = 0.12, c11: float = 2800.0, c22: float = 1400.0, c12: float = 0.0, g: float = 45.0, bend_warp: float = 7e-06, bend_weft: float = 6e-06, bend_bias: float = 6e-06, bend_hysteresis_warp: float = 0.0, bend_hysteresis_weft: float = 0.0, bend_set: float = 0.0, damping: float = 0.002, thickness: float = 0.0005, friction: float = 0.3, strain_limit: float = 0.0, strength: float = 0.0, stretch_warp: Sequence[tuple[float, float]] = [], stretch_weft: Sequence[tuple[float, float]] = []) -> None: ...

    @property
    def density(self) -> float:
        """
        Mass per area of the fabric. Typical: 0.03 (chiffon) to 0.5 (coating). Higher: hangs straighter and moves less in wind. [kg/m²]
        """

    @density.setter
    def density(self, value: float, /) -> None: ...

    @property
    def c11(self) -> float:
        """
        Stretching stiffness along warp. Typical: 25 (jumper) to 10000 (canvas). Higher: sags and stretches less. [N/m]
        """

    @c11.setter
    def c11(self, value: float, /) -> None: ...

    @property
    def c22(self) -> float:
        """
        Stretching stiffness along weft. Typical values as along warp. Higher: stretches less across warp. [N/m]
        """

    @c22.setter
    def c22(self, value: float, /) -> None: ...

    @property
    def c12(self) -> float:
        """
        Coupling of warp and weft; 0 for most woven fabric. Higher: narrows more when pulled. Its square is below c11 times c22. [N/m]
        """

    @c12.setter
    def c12(self, value: float, /) -> None: ...

    @property
    def g(self) -> float:
        """
        Shearing stiffness. Typical: 14 (silk) to 120 (denim), 700 (leather). Higher: resists skewing, and drapes in fewer, stiffer folds. [N/m]
        """

    @g.setter
    def g(self, value: float, /) -> None: ...

    @property
    def bend_warp(self) -> float:
        """
        Bending rigidity along warp. Typical: 1e-6 (silk) to 1e-4 (coating). Higher: larger and fewer folds. [N·m]
        """

    @bend_warp.setter
    def bend_warp(self, value: float, /) -> None: ...

    @property
    def bend_weft(self) -> float:
        """
        Bending rigidity along weft. Typical values as along warp. Higher: larger folds across weft. [N·m]
        """

    @bend_weft.setter
    def bend_weft(self, value: float, /) -> None: ...

    @property
    def bend_bias(self) -> float:
        """
        Bending rigidity at 45° to warp, at least (√bend_warp − √bend_weft)²/4. Higher: larger diagonal folds. [N·m]
        """

    @bend_bias.setter
    def bend_bias(self, value: float, /) -> None: ...

    @property
    def bend_hysteresis_warp(self) -> float:
        """
        Hysteresis of bending along warp by friction between threads, 2HB of KES-F. Typical: 1e-4 (silk) to 5e-3 (coating); 0: none. Higher: fewer folds, which stay. [N]
        """

    @bend_hysteresis_warp.setter
    def bend_hysteresis_warp(self, value: float, /) -> None: ...

    @property
    def bend_hysteresis_weft(self) -> float:
        """
        Hysteresis of bending along weft. Typical values as along warp. Higher: folds across weft stay. [N]
        """

    @bend_hysteresis_weft.setter
    def bend_hysteresis_weft(self, value: float, /) -> None: ...

    @property
    def bend_set(self) -> float:
        """
        Curvature of threads beyond which bending stays, as in creases. Typical: 500 to 2000; 0: none. Lower: creases sooner. [1/m]
        """

    @bend_set.setter
    def bend_set(self, value: float, /) -> None: ...

    @property
    def damping(self) -> float:
        """
        Time constant of internal damping, in stretching, shearing and bending. Typical: 0.001 to 0.03. Higher: small, quick wrinkles decay sooner. [s]
        """

    @damping.setter
    def damping(self, value: float, /) -> None: ...

    @property
    def thickness(self) -> float:
        """
        Minimum distance between two layers of the fabric. Typical: 0.0001 to 0.002. Higher: thicker stacks, earlier contact. [m]
        """

    @thickness.setter
    def thickness(self, value: float, /) -> None: ...

    @property
    def friction(self) -> float:
        """
        Coulomb coefficient of the fabric on cloth. Typical: 0.2 (silk) to 0.6 (wool). Higher: slides later.
        """

    @friction.setter
    def friction(self, value: float, /) -> None: ...

    @property
    def strain_limit(self) -> float:
        """
        Greatest strain in any direction; 0: no limit, 0.01: 1 %. Higher: more rubbery, and less work for the solver.
        """

    @strain_limit.setter
    def strain_limit(self, value: float, /) -> None: ...

    @property
    def strength(self) -> float:
        """
        Tension at which the fabric tears. Typical: 3000 (chiffon) to 40000 (denim), less for an effect; 0: never. Higher: tears later. [N/m]
        """

    @strength.setter
    def strength(self, value: float, /) -> None: ...

    @property
    def stretch_warp(self) -> Sequence[tuple[float, float]]:
        """
        Measured curve along warp, instead of c11: points of strain [1] and tension [N/m], both rising.
        """

    @stretch_warp.setter
    def stretch_warp(self, value: Sequence[tuple[float, float]], /) -> None: ...

    @property
    def stretch_weft(self) -> Sequence[tuple[float, float]]:
        """
        Measured curve along weft, instead of c22, of the same form. At most 8 points each.
        """

    @stretch_weft.setter
    def stretch_weft(self, value: Sequence[tuple[float, float]], /) -> None: ...

    def _replace(self, **changes: object) -> Fabric:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Springs:
    """Cloth made of springs, whose stiffness depends on the mesh."""

    def __init__(self, *, density: float = 0.2, structural: float = 2000.0, shear: float = 1000.0, bend: float = 20.0, damping: float = 0.0, damping_kind: Literal['plain', 'projected'] = 'projected', thickness: float = 0.001, friction: float = 0.3) -> None: ...

    @property
    def density(self) -> float:
        """
        Mass per area of a cloth of springs. Higher: heavier, so that it stretches more. [kg/m²]
        """

    @density.setter
    def density(self, value: float, /) -> None: ...

    @property
    def structural(self) -> float:
        """
        Stiffness of the springs along the edges of the mesh. Higher: stretches less, and needs more work. [N/m]
        """

    @structural.setter
    def structural(self, value: float, /) -> None: ...

    @property
    def shear(self) -> float:
        """
        Stiffness of the diagonal springs of a grid's cells. Higher: skews less. Not used on meshes. [N/m]
        """

    @shear.setter
    def shear(self, value: float, /) -> None: ...

    @property
    def bend(self) -> float:
        """
        Stiffness of the springs that resist bending. Higher: larger and stiffer folds. [N/m]
        """

    @bend.setter
    def bend(self, value: float, /) -> None: ...

    @property
    def damping(self) -> float:
        """
        Damping coefficient of every spring. Higher: vibration decays sooner; explicit integrators need shorter steps. [N·s/m]
        """

    @damping.setter
    def damping(self, value: float, /) -> None: ...

    @property
    def damping_kind(self) -> Literal['plain', 'projected']:
        """
        Damped part of the relative velocity of two ends: all (the paper's), or along the spring. Only the first also brakes rotation.
        """

    @damping_kind.setter
    def damping_kind(self, value: Literal['plain', 'projected'], /) -> None: ...

    @property
    def thickness(self) -> float:
        """
        Minimum distance between layers, half of it to colliders. Higher: thicker stacks. Not given: at most half of a mean edge. [m]
        """

    @thickness.setter
    def thickness(self, value: float, /) -> None: ...

    @property
    def friction(self) -> float:
        """
        Coulomb coefficient of a cloth of springs on cloth. Higher: layers stick sooner.
        """

    @friction.setter
    def friction(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> Springs:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

def fabric_presets() -> list[tuple[str, str]]:
    """Names and titles of all presets."""

def find_fabric(name: str) -> Fabric:
    """The fabric of a preset."""

def fabric_sources(name: str) -> dict[str, str]:
    """Sources of a preset's numbers."""

class KesSheet:
    """
    A sheet of the Kawabata Evaluation System (KES-F), in its printed units: weight [mg/cm²], thickness [mm], extension at 500 gf/cm [%], linearity LT [1], shear G [gf/(cm·degree)], bending B [gf·cm²/cm], its hysteresis 2HB [gf·cm/cm], friction MIU [1].
    """

    def __init__(self, *, weight: float = 0.0, thickness: float = 0.0, extension_warp: float = 0.0, extension_weft: float = 0.0, linearity_warp: float = 1.0, linearity_weft: float = 1.0, shear: float = 0.0, bend_warp: float = 0.0, bend_weft: float = 0.0, hysteresis_warp: float = 0.0, hysteresis_weft: float = 0.0, friction: float = 0.3) -> None: ...

    @property
    def weight(self) -> float: ...

    @weight.setter
    def weight(self, value: float, /) -> None: ...

    @property
    def thickness(self) -> float: ...

    @thickness.setter
    def thickness(self, value: float, /) -> None: ...

    @property
    def extension_warp(self) -> float: ...

    @extension_warp.setter
    def extension_warp(self, value: float, /) -> None: ...

    @property
    def extension_weft(self) -> float: ...

    @extension_weft.setter
    def extension_weft(self, value: float, /) -> None: ...

    @property
    def linearity_warp(self) -> float: ...

    @linearity_warp.setter
    def linearity_warp(self, value: float, /) -> None: ...

    @property
    def linearity_weft(self) -> float: ...

    @linearity_weft.setter
    def linearity_weft(self, value: float, /) -> None: ...

    @property
    def shear(self) -> float: ...

    @shear.setter
    def shear(self, value: float, /) -> None: ...

    @property
    def bend_warp(self) -> float: ...

    @bend_warp.setter
    def bend_warp(self, value: float, /) -> None: ...

    @property
    def bend_weft(self) -> float: ...

    @bend_weft.setter
    def bend_weft(self, value: float, /) -> None: ...

    @property
    def hysteresis_warp(self) -> float: ...

    @hysteresis_warp.setter
    def hysteresis_warp(self, value: float, /) -> None: ...

    @property
    def hysteresis_weft(self) -> float: ...

    @hysteresis_weft.setter
    def hysteresis_weft(self, value: float, /) -> None: ...

    @property
    def friction(self) -> float: ...

    @friction.setter
    def friction(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> KesSheet:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

@overload
def fabric_from(sheet: KesSheet) -> Fabric: ...

@overload
def fabric_from(sheet: FastSheet) -> Fabric: ...

@overload
def fabric_from(sheet: CloProperties) -> Fabric:
    """The fabric of a laboratory sheet, in SI units."""

class FastSheet:
    """
    A sheet of SiroFAST, in its printed units: weight [g/m²], thickness T2 [mm], bending lengths [mm], extensions under 5 and 20 gf/cm and along the bias [%], friction [1].
    """

    def __init__(self, *, weight: float = 0.0, thickness: float = 0.0, bending_length_warp: float = 0.0, bending_length_weft: float = 0.0, extension_5_warp: float = 0.0, extension_20_warp: float = 0.0, extension_5_weft: float = 0.0, extension_20_weft: float = 0.0, bias_extension: float = 0.0, friction: float = 0.3) -> None: ...

    @property
    def weight(self) -> float: ...

    @weight.setter
    def weight(self, value: float, /) -> None: ...

    @property
    def thickness(self) -> float: ...

    @thickness.setter
    def thickness(self, value: float, /) -> None: ...

    @property
    def bending_length_warp(self) -> float: ...

    @bending_length_warp.setter
    def bending_length_warp(self, value: float, /) -> None: ...

    @property
    def bending_length_weft(self) -> float: ...

    @bending_length_weft.setter
    def bending_length_weft(self, value: float, /) -> None: ...

    @property
    def extension_5_warp(self) -> float: ...

    @extension_5_warp.setter
    def extension_5_warp(self, value: float, /) -> None: ...

    @property
    def extension_20_warp(self) -> float: ...

    @extension_20_warp.setter
    def extension_20_warp(self, value: float, /) -> None: ...

    @property
    def extension_5_weft(self) -> float: ...

    @extension_5_weft.setter
    def extension_5_weft(self, value: float, /) -> None: ...

    @property
    def extension_20_weft(self) -> float: ...

    @extension_20_weft.setter
    def extension_20_weft(self, value: float, /) -> None: ...

    @property
    def bias_extension(self) -> float: ...

    @bias_extension.setter
    def bias_extension(self, value: float, /) -> None: ...

    @property
    def friction(self) -> float: ...

    @friction.setter
    def friction(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> FastSheet:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class CloProperties:
    """
    Physical properties of CLO and Marvelous Designer: density [g/m²], thickness [mm], stretch and shear [g/s²], bending [g·mm²/s²], friction [1].
    """

    def __init__(self, *, density: float = 0.0, thickness: float = 0.0, stretch_warp: float = 0.0, stretch_weft: float = 0.0, shear: float = 0.0, bend_warp: float = 0.0, bend_weft: float = 0.0, bend_bias: float = 0.0, friction: float = 0.3) -> None: ...

    @property
    def density(self) -> float: ...

    @density.setter
    def density(self, value: float, /) -> None: ...

    @property
    def thickness(self) -> float: ...

    @thickness.setter
    def thickness(self, value: float, /) -> None: ...

    @property
    def stretch_warp(self) -> float: ...

    @stretch_warp.setter
    def stretch_warp(self, value: float, /) -> None: ...

    @property
    def stretch_weft(self) -> float: ...

    @stretch_weft.setter
    def stretch_weft(self, value: float, /) -> None: ...

    @property
    def shear(self) -> float: ...

    @shear.setter
    def shear(self, value: float, /) -> None: ...

    @property
    def bend_warp(self) -> float: ...

    @bend_warp.setter
    def bend_warp(self, value: float, /) -> None: ...

    @property
    def bend_weft(self) -> float: ...

    @bend_weft.setter
    def bend_weft(self, value: float, /) -> None: ...

    @property
    def bend_bias(self) -> float: ...

    @bend_bias.setter
    def bend_bias(self, value: float, /) -> None: ...

    @property
    def friction(self) -> float: ...

    @friction.setter
    def friction(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> CloProperties:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class ExplicitSettings:
    """Settings of the integrator `explicit`."""

    def __init__(self, *, substeps: int = 0) -> None: ...

    @property
    def substeps(self) -> int:
        """
        Substeps per step of the explicit integrator; 0: as many as stability requires. More: slower and more stable.
        """

    @substeps.setter
    def substeps(self, value: int, /) -> None: ...

    def _replace(self, **changes: object) -> ExplicitSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class PaperSettings:
    """Settings of the integrators `paper` and `paper_fixed`."""

    def __init__(self, *, printed_damping_sign: bool = False) -> None: ...

    @property
    def printed_damping_sign(self) -> bool:
        """
        Sign of the damping force. The sign printed in the paper amplifies motion.
        """

    @printed_damping_sign.setter
    def printed_damping_sign(self, value: bool, /) -> None: ...

    def _replace(self, **changes: object) -> PaperSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class ImplicitEulerSettings:
    """Settings of the integrator `implicit_euler`."""

    def __init__(self, *, tolerance: float = 0.01, iterations: int = 50) -> None: ...

    @property
    def tolerance(self) -> float:
        """
        Largest velocity change at which the Newton steps of implicit_euler end. Higher: faster and less accurate. [m/s]
        """

    @tolerance.setter
    def tolerance(self, value: float, /) -> None: ...

    @property
    def iterations(self) -> int:
        """
        Iterations: conjugate gradients per Newton step of newton, Newton steps of implicit_euler. More: slower and more accurate.
        """

    @iterations.setter
    def iterations(self, value: int, /) -> None: ...

    def _replace(self, **changes: object) -> ImplicitEulerSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class NewtonSettings:
    """Settings of the integrator `newton`."""

    def __init__(self, *, iterations: int = 0, quality: Literal['fast', 'default', 'high'] = 'default') -> None: ...

    @property
    def iterations(self) -> int:
        """
        Iterations: conjugate gradients per Newton step of newton, Newton steps of implicit_euler. More: slower and more accurate.
        """

    @iterations.setter
    def iterations(self, value: int, /) -> None: ...

    @property
    def quality(self) -> Literal['fast', 'default', 'high']:
        """
        Solver budget of newton with automatic iterations: half, one or two times the usual. High: slower and more accurate.
        """

    @quality.setter
    def quality(self, value: Literal['fast', 'default', 'high'], /) -> None: ...

    def _replace(self, **changes: object) -> NewtonSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class XpbdSettings:
    """Settings of the integrator `xpbd`."""

    def __init__(self, *, substeps: int = 50) -> None: ...

    @property
    def substeps(self) -> int:
        """Substeps per step of xpbd. More: slower, and cloth stretches less."""

    @substeps.setter
    def substeps(self, value: int, /) -> None: ...

    def _replace(self, **changes: object) -> XpbdSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class IntegratorSettings:
    """An integrator and its settings."""

    def __init__(self, *, integrator: str = 'newton', explicit_euler: ExplicitSettings = ExplicitSettings(substeps=0), paper: PaperSettings = PaperSettings(printed_damping_sign=False), implicit_euler: ImplicitEulerSettings = ImplicitEulerSettings(tolerance=0.01, iterations=50), newton: NewtonSettings = NewtonSettings(iterations=0, quality='default'), xpbd: XpbdSettings = XpbdSettings(substeps=50), is_double: bool = False) -> None: ...

    @property
    def integrator(self) -> str:
        """
        Method of time integration. Fabrics need newton, implicit_euler or xpbd.
        """

    @integrator.setter
    def integrator(self, value: str, /) -> None: ...

    @property
    def explicit_euler(self) -> ExplicitSettings: ...

    @explicit_euler.setter
    def explicit_euler(self, value: ExplicitSettings, /) -> None: ...

    @property
    def paper(self) -> PaperSettings: ...

    @paper.setter
    def paper(self, value: PaperSettings, /) -> None: ...

    @property
    def implicit_euler(self) -> ImplicitEulerSettings: ...

    @implicit_euler.setter
    def implicit_euler(self, value: ImplicitEulerSettings, /) -> None: ...

    @property
    def newton(self) -> NewtonSettings: ...

    @newton.setter
    def newton(self, value: NewtonSettings, /) -> None: ...

    @property
    def xpbd(self) -> XpbdSettings: ...

    @xpbd.setter
    def xpbd(self, value: XpbdSettings, /) -> None: ...

    @property
    def is_double(self) -> bool:
        """
        Floating-point precision of states. "double": slow reference solutions with newton and implicit_euler.
        """

    @is_double.setter
    def is_double(self, value: bool, /) -> None: ...

    def _replace(self, **changes: object) -> IntegratorSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class StepDivision:
    """Division of steps that end with excess stretch, collapse or energy."""

    def __init__(self, *, enabled: bool | None = None, shortest: float = 0.00026041666666666666) -> None: ...

    @property
    def enabled(self) -> bool | None:
        """
        Whether steps in contact with poor results are divided. Default: with newton only; also available with implicit_euler.
        """

    @enabled.setter
    def enabled(self, value: bool | None, /) -> None: ...

    @property
    def shortest(self) -> float:
        """Shortest part of a step, > 0 [s]"""

    @shortest.setter
    def shortest(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> StepDivision:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class ContactSettings:
    """Contact of cloth with colliders, itself and other cloth."""

    def __init__(self, *, enabled: bool = True, tracks_points: bool = False) -> None: ...

    @property
    def enabled(self) -> bool:
        """
        Whether cloth collides with colliders, itself and other cloth. Off: cheaper steps.
        """

    @enabled.setter
    def enabled(self, value: bool, /) -> None: ...

    @property
    def tracks_points(self) -> bool:
        """Whether `World.contacts` returns the contacts of the last step."""

    @tracks_points.setter
    def tracks_points(self, value: bool, /) -> None: ...

    def _replace(self, **changes: object) -> ContactSettings:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

def integrator_names() -> list[str]:
    """Names of all integrators."""

class Air:
    """Aerodynamic drag and lift per triangle."""

    def __init__(self, *, density: float = 0.0, drag: float = 1.2, lift: float = 0.6) -> None: ...

    @property
    def density(self) -> float:
        """Density of the air. Higher: stronger drag and lift. [kg/m³]"""

    @density.setter
    def density(self, value: float, /) -> None: ...

    @property
    def drag(self) -> float:
        """
        Drag coefficient of a triangle face-on. Higher: falls and swings slower.
        """

    @drag.setter
    def drag(self, value: float, /) -> None: ...

    @property
    def lift(self) -> float:
        """
        Lift coefficient of a slanted triangle, at most the drag coefficient. Higher: glides sideways in falling and flutters.
        """

    @lift.setter
    def lift(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> Air:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Gusts:
    """Velocity fluctuation of the air: smooth noise in space and time."""

    def __init__(self, *, strength: float = 0.0, length: float = 1.0, time: float = 0.5, seed: int = 1) -> None: ...

    @property
    def strength(self) -> float:
        """
        Root mean square of the gusts along each axis. Higher: stronger gusts. [m/s]
        """

    @strength.setter
    def strength(self, value: float, /) -> None: ...

    @property
    def length(self) -> float:
        """Correlation length of the gusts. Longer: broader gusts. [m]"""

    @length.setter
    def length(self, value: float, /) -> None: ...

    @property
    def time(self) -> float:
        """Correlation time of the gusts. Longer: slower gusts. [s]"""

    @time.setter
    def time(self, value: float, /) -> None: ...

    @property
    def seed(self) -> int:
        """Seed of the gusts. Equal seeds give equal gusts."""

    @seed.setter
    def seed(self, value: int, /) -> None: ...

    def _replace(self, **changes: object) -> Gusts:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class WindKey:
    """Velocity of the air at a time; linear between keys."""

    def __init__(self, *, time: float = 0.0, velocity: Sequence[float] = (0.0, 0.0, 0.0)) -> None: ...

    @property
    def time(self) -> float:
        """[s]"""

    @time.setter
    def time(self, value: float, /) -> None: ...

    @property
    def velocity(self) -> Sequence[float]:
        """[m/s]"""

    @velocity.setter
    def velocity(self, value: Sequence[float], /) -> None: ...

    def _replace(self, **changes: object) -> WindKey:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Wind:
    """Motion of the air, and its forces on cloth."""

    def __init__(self, *, velocity: Sequence[float] = (0.0, 0.0, 0.0), keys: Sequence[WindKey] = [], drag: float = 0.0, air: Air = Air(density=0.0, drag=1.2, lift=0.6), gusts: Gusts = Gusts(strength=0.0, length=1.0, time=0.5, seed=1)) -> None: ...

    @property
    def velocity(self) -> Sequence[float]:
        """Velocity of a steady wind. Higher: pushes harder. [m/s]"""

    @velocity.setter
    def velocity(self, value: Sequence[float], /) -> None: ...

    @property
    def keys(self) -> Sequence[WindKey]:
        """
        Key frames of a changing wind, linear between keys and constant outside.
        """

    @keys.setter
    def keys(self, value: Sequence[WindKey], /) -> None: ...

    @property
    def drag(self) -> float:
        """
        Drag per area and relative velocity, the same for every orientation of the cloth. Higher: follows the wind more closely. [N·s/m³]
        """

    @drag.setter
    def drag(self, value: float, /) -> None: ...

    @property
    def air(self) -> Air:
        """
        Aerodynamic drag and lift of each triangle. Requires newton or implicit_euler.
        """

    @air.setter
    def air(self, value: Air, /) -> None: ...

    @property
    def gusts(self) -> Gusts:
        """
        Random velocity in addition to the wind, smooth in space and time. Requires `air`.
        """

    @gusts.setter
    def gusts(self, value: Gusts, /) -> None: ...

    def _replace(self, **changes: object) -> Wind:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class KeyFrame:
    """Displacement from the initial pose at a time."""

    def __init__(self, *, time: float = 0.0, translation: Sequence[float] = (0.0, 0.0, 0.0), angles_deg: Sequence[float] = (0.0, 0.0, 0.0)) -> None: ...

    @property
    def time(self) -> float:
        """[s]"""

    @time.setter
    def time(self, value: float, /) -> None: ...

    @property
    def translation(self) -> Sequence[float]:
        """[m]"""

    @translation.setter
    def translation(self, value: Sequence[float], /) -> None: ...

    @property
    def angles_deg(self) -> Sequence[float]:
        """About fixed x, then y, then z [degrees]"""

    @angles_deg.setter
    def angles_deg(self, value: Sequence[float], /) -> None: ...

    def _replace(self, **changes: object) -> KeyFrame:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Grid:
    """Rectangular cloth as a grid of particles in the plane y = 0."""

    def __init__(self, *, size_x: float = 1.0, size_z: float = 1.0, cells_x: int = 32, cells_z: int = 32) -> None: ...

    @property
    def size_x(self) -> float:
        """Length along x, > 0 [m]"""

    @size_x.setter
    def size_x(self, value: float, /) -> None: ...

    @property
    def size_z(self) -> float:
        """Length along z, > 0 [m]"""

    @size_z.setter
    def size_z(self, value: float, /) -> None: ...

    @property
    def cells_x(self) -> int:
        """Cells along x, at least 1"""

    @cells_x.setter
    def cells_x(self, value: int, /) -> None: ...

    @property
    def cells_z(self) -> int:
        """Cells along z, at least 1"""

    @cells_z.setter
    def cells_z(self, value: int, /) -> None: ...

    def _replace(self, **changes: object) -> Grid:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

    @property
    def num_particles(self) -> int:
        """(cells_x + 1) · (cells_z + 1)"""

    def index(self, i: int, j: int) -> int:
        """The particle at column i along x and row j along z."""

class Sphere:
    """A solid ball."""

    def __init__(self, *, center: Sequence[float] = (0.0, 0.0, 0.0), radius: float = 1.0) -> None: ...

    @property
    def center(self) -> Sequence[float]:
        """[m]"""

    @center.setter
    def center(self, value: Sequence[float], /) -> None: ...

    @property
    def radius(self) -> float:
        """> 0 [m]"""

    @radius.setter
    def radius(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> Sphere:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Plane:
    """A half space: everything below the plane is solid."""

    def __init__(self, *, point: Sequence[float] = (0.0, 0.0, 0.0), normal: Sequence[float] = (0.0, 1.0, 0.0)) -> None: ...

    @property
    def point(self) -> Sequence[float]:
        """[m]"""

    @point.setter
    def point(self, value: Sequence[float], /) -> None: ...

    @property
    def normal(self) -> Sequence[float]:
        """Upwards out of the solid, of length 1"""

    @normal.setter
    def normal(self, value: Sequence[float], /) -> None: ...

    def _replace(self, **changes: object) -> Plane:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Capsule:
    """All points within a radius of the segment from a to b."""

    def __init__(self, *, a: Sequence[float] = (0.0, 0.0, 0.0), b: Sequence[float] = (0.0, 1.0, 0.0), radius: float = 0.5) -> None: ...

    @property
    def a(self) -> Sequence[float]:
        """[m]"""

    @a.setter
    def a(self, value: Sequence[float], /) -> None: ...

    @property
    def b(self) -> Sequence[float]:
        """[m]"""

    @b.setter
    def b(self, value: Sequence[float], /) -> None: ...

    @property
    def radius(self) -> float:
        """> 0 [m]"""

    @radius.setter
    def radius(self, value: float, /) -> None: ...

    def _replace(self, **changes: object) -> Capsule:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

class Box:
    """
    A solid box; turn it with the argument `rotation` of `World.add_collider`.
    """

    def __init__(self, *, center: Sequence[float] = (0.0, 0.0, 0.0), half_size: Sequence[float] = (0.5, 0.5, 0.5)) -> None: ...

    @property
    def center(self) -> Sequence[float]:
        """[m]"""

    @center.setter
    def center(self, value: Sequence[float], /) -> None: ...

    @property
    def half_size(self) -> Sequence[float]:
        """Along x, y and z, > 0 [m]"""

    @half_size.setter
    def half_size(self, value: Sequence[float], /) -> None: ...

    def _replace(self, **changes: object) -> Box:
        """A copy with some values changed."""

    def _asdict(self) -> dict[str, Any]:
        """The values by their names."""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, Any]: ...

    def __setstate__(self, values: dict[str, Any], /) -> None: ...

def rotation_from_angles(angles_deg: Sequence[float]) -> NDArray[numpy.float64]:
    """The rotation about fixed x, then y, then z, as a matrix."""

def rotation_from_quaternion(w: float, x: float, y: float, z: float) -> NDArray[numpy.float64]:
    """The rotation of a quaternion, as a matrix."""

def parameters() -> list[dict[str, Any]]:
    """All keys of scene files."""

class WorkTimes:
    """Wall time of a step by kind of work; the kinds do not overlap."""

    @property
    def total(self) -> float:
        """Of whole steps [s]"""

    @property
    def lists(self) -> float:
        """Broad phase: candidate pair lists [s]"""

    @property
    def narrow_phase(self) -> float:
        """Distances of listed pairs and of primitive shapes [s]"""

    @property
    def rows(self) -> float:
        """Contacts in the solve: their linearisation and energy [s]"""

    @property
    def set_up(self) -> float:
        """Preconditioners rebuilt for contacts [s]"""

    @property
    def product(self) -> float:
        """Products of the contact Hessian with a vector [s]"""

    @property
    def v_cycle(self) -> float:
        """Preconditioners applied [s]"""

    @property
    def projection(self) -> float:
        """Gauss–Seidel on positions and velocities [s]"""

    @property
    def ccd(self) -> float:
        """Continuous collision detection [s]"""

    @property
    def retries(self) -> float:
        """All work of discarded parts of steps: not a separate kind [s]"""

    @property
    def pairs_listed(self) -> int:
        """In the longest list"""

    @property
    def pairs_tested(self) -> int:
        """In all passes over the list together"""

    @property
    def active(self) -> int:
        """Contacts with a force"""

class StepWarning:
    """
    A problem of a step. `World.describe` gives the sentence, with the key to change.
    """

    @property
    def code(self) -> str:
        """Its kind, as "yarn_strain\""""

    @property
    def cloth(self) -> int | None:
        """Index in `World.cloths`; None: no specific one"""

    @property
    def particle(self) -> int | None:
        """Its index; None: no specific one"""

    @property
    def value(self) -> float:
        """See the code: a strain, a share, an energy [J], a number"""

    @property
    def fault(self) -> str:
        """The reason, of "cap_reached\""""

    @property
    def collider(self) -> int | None:
        """Index in `World.colliders`, of "penetration"; else None"""

    def __repr__(self) -> str: ...

class InfeasiblePair:
    """A pair of features that prescribed motions leave no room for."""

    @property
    def cloth(self) -> int | None:
        """Index in `World.cloths`"""

    @property
    def particle(self) -> int | None:
        """Of `cloth`"""

    @property
    def other_cloth(self) -> int | None:
        """Index in `World.cloths`; None: a collider"""

    @property
    def other_particle(self) -> int | None:
        """Of `other_cloth`"""

    @property
    def collider(self) -> int | None:
        """Index in `World.colliders`; None: cloth"""

    @property
    def kind(self) -> str:
        """
        "passed": pushed through each other; "caught": between colliders that overlap
        """

class StepReport:
    """Result of a step."""

    @property
    def ok(self) -> bool:
        """False: the step failed, and every cloth has its state before the step."""

    @property
    def warnings(self) -> list[StepWarning]:
        """
        Problems of a step that was made: the result is below the requested accuracy.
        """

    @property
    def substeps(self) -> int:
        """Of the cloth with the most"""

    @property
    def divisions(self) -> int:
        """Parts of the divided step"""

    @property
    def retries(self) -> int:
        """Parts that were too long, and were repeated"""

    @property
    def fault(self) -> str | None:
        """
        Of the worst repeated part: "stretch", "collapse", "energy", …; None: none
        """

    @property
    def iterations(self) -> int:
        """Of nonlinear solvers, over all cloths"""

    @property
    def linear_iterations(self) -> int | None:
        """Of linear solvers inside them; None without any"""

    @property
    def residual(self) -> float | None:
        """
        Of newton's linear solves, before the last iteration of each: the largest √(rᵀP⁻¹r) as a share of that at its start; None for other integrators
        """

    @property
    def guard_events(self) -> int | None:
        """Of newton's guard; None for other integrators"""

    @property
    def hits(self) -> int:
        """Pairs that reached continuous collision detection"""

    @property
    def zones(self) -> int:
        """Its rigid impact zones"""

    @property
    def torn(self) -> int:
        """
        Cuts through vertices where cloth tore: its particles and triangles have changed
        """

    @property
    def infeasible(self) -> list[InfeasiblePair]:
        """Pairs pushed through each other by prescribed motions"""

    @property
    def work(self) -> WorkTimes:
        """Wall time by kind of work"""

    @property
    def _is_clean(self) -> bool:
        """No problem at all"""

    def __repr__(self) -> str: ...

class VertexMotion:
    """
    Vertices of a mesh as a function of time: skins, morph targets and nodes of a glTF file. From `read_gltf`.
    """

    @property
    def num_vertices(self) -> int:
        """The number of vertices."""

    @property
    def start(self) -> float:
        """Time of the first key [s]."""

    @property
    def end(self) -> float:
        """Time of the last key [s]."""

    def positions(self, time: float) -> NDArray[numpy.float64]:
        """
        Positions at a time [s]: (num_vertices, 3), constant before `start` and after `end` [m].
        """

class ClothId:
    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    @property
    def number(self) -> int: ...

    def __deepcopy__(self, memo: object) -> ClothId: ...

class ColliderId:
    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    @property
    def number(self) -> int: ...

    def __deepcopy__(self, memo: object) -> ColliderId: ...

class Snapshot:
    """State of a world at a time, from `World.snapshot`."""

class World:
    def __init__(self) -> None: ...

    def add_cloth(self, arg0: str, arg1: object, arg2: str, arg3: object, arg4: str, arg5: str, arg6: Sequence[float] | None, arg7: str, arg8: Sequence[float], arg9: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], arg10: Sequence[float], arg11: float | None, arg12: float, arg13: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)] | None, arg14: Sequence[tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], float, float]], arg15: Sequence[tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)]]], arg16: Sequence[Sequence[int]], arg17: float, arg18: float | None, arg19: int, arg20: bool, /) -> ClothId: ...

    def add_collider(self, arg0: str, arg1: object, arg2: str, arg3: bool | None, arg4: Sequence[float], arg5: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], arg6: Sequence[KeyFrame], arg7: object, arg8: VertexMotion | None, arg9: float, arg10: float, arg11: float, /) -> ColliderId: ...

    @overload
    def remove(self, arg: ClothId, /) -> None: ...

    @overload
    def remove(self, arg: ColliderId, /) -> None: ...

    @overload
    def contains(self, arg: ClothId, /) -> bool: ...

    @overload
    def contains(self, arg: ColliderId, /) -> bool: ...

    def cloth_ids(self) -> list[ClothId]: ...

    def collider_ids(self) -> list[ColliderId]: ...

    @overload
    def name(self, arg: ClothId, /) -> str: ...

    @overload
    def name(self, arg: ColliderId, /) -> str: ...

    def notes(self, id: ClothId) -> tuple[NDArray[numpy.int32], list[str], list[str]]: ...

    def warnings(self, arg: ColliderId, /) -> list[str]: ...

    def grid(self, arg: ClothId, /) -> Grid | None: ...

    def fabric(self, id: ClothId) -> Fabric | Springs: ...

    def friction(self, arg: ColliderId, /) -> tuple[float, float]: ...

    def move_collider(self, arg0: ColliderId, arg1: Sequence[float], arg2: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def place_collider(self, arg0: ColliderId, arg1: Sequence[float], arg2: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def pose(self, id: ColliderId) -> tuple[tuple[float, float, float], NDArray[numpy.float64]]: ...

    def move_vertices(self, arg0: ColliderId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def place_vertices(self, arg0: ColliderId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def add_pin(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], arg2: Sequence[KeyFrame], arg3: Sequence[float], arg4: ColliderId | None, arg5: float | None, arg6: float, /) -> None: ...

    def unpin(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], /) -> None: ...

    def pinned_particles(self, arg: ClothId, /) -> NDArray[numpy.int32]: ...

    def move_pins(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def set_forces(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def set_pressure(self, arg0: ClothId, arg1: float, arg2: bool, /) -> None: ...

    def pressure(self, arg: ClothId, /) -> float: ...

    def volume(self, arg: ClothId, /) -> float: ...

    def set_positions(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def set_velocities(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

    def teleport(self, arg0: ClothId, arg1: Sequence[float], arg2: Annotated[NDArray[numpy.float64], dict(shape=(3, 3), order='C', device='cpu', writable=False)], arg3: bool, /) -> None: ...

    def set_fabric(self, arg0: ClothId, arg1: object, /) -> None: ...

    def stiffen(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], arg2: float, /) -> None: ...

    def set_friction(self, arg0: ColliderId, arg1: float, arg2: float, /) -> None: ...

    def set_pair_friction(self, arg0: object, arg1: object, arg2: float, arg3: float, /) -> None: ...

    def set_collision(self, arg0: object, arg1: object, arg2: bool, /) -> None: ...

    @property
    def gravity(self) -> tuple[float, float, float]: ...

    @gravity.setter
    def gravity(self, arg: Sequence[float], /) -> None: ...

    @property
    def wind(self) -> Wind: ...

    @wind.setter
    def wind(self, arg: Wind, /) -> None: ...

    @property
    def integrator(self) -> IntegratorSettings: ...

    @integrator.setter
    def integrator(self, arg: IntegratorSettings, /) -> None: ...

    @property
    def division(self) -> StepDivision: ...

    @division.setter
    def division(self, arg: StepDivision, /) -> None: ...

    @property
    def contact(self) -> ContactSettings: ...

    @contact.setter
    def contact(self, arg: ContactSettings, /) -> None: ...

    @property
    def threads(self) -> int: ...

    @threads.setter
    def threads(self, arg: int, /) -> None: ...

    def num_particles(self, arg: ClothId, /) -> int: ...

    def faces(self, arg: ClothId, /) -> NDArray[numpy.int32]: ...

    def uv(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def rest_positions(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def offsets(self, id: ClothId) -> NDArray[numpy.float32]: ...

    def origin(self, arg: ClothId, /) -> tuple[float, float, float]: ...

    @overload
    def copy_positions(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    @overload
    def copy_positions(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    @overload
    def copy_velocities(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    @overload
    def copy_velocities(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    @overload
    def copy_normals(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    @overload
    def copy_normals(self, arg0: ClothId, arg1: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order='C', device='cpu')], /) -> None: ...

    def vertex_positions(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def masses(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def forces(self, arg0: ClothId, arg1: str | None, /) -> NDArray[numpy.float64]: ...

    def pin_forces(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def spring_strains(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def triangle_strains(self, arg: ClothId, /) -> NDArray[numpy.float64]: ...

    def contacts(self) -> NDArray[numpy.uint8]: ...

    def energies(self) -> tuple[float, float, float, float]: ...

    def momentum(self, arg: ClothId, /) -> tuple[float, float, float]: ...

    def center_of_mass(self, arg: ClothId, /) -> tuple[float, float, float]: ...

    def cast_ray(self, origin: tuple[float, float, float], direction: tuple[float, float, float], reach: float) -> dict[str, Any] | None: ...

    def closest_point(self, point: tuple[float, float, float], reach: float) -> dict[str, Any] | None: ...

    def untangle(self) -> list[str]: ...

    def step(self, arg: float, /) -> StepReport: ...

    @property
    def time(self) -> float: ...

    def clone(self) -> World: ...

    def snapshot(self) -> Snapshot: ...

    def restore(self, arg: Snapshot, /) -> None: ...

    def save(self) -> bytes: ...

    @staticmethod
    def load(arg: bytes, /) -> World: ...

    def state_hash(self) -> str: ...

    def describe(self, arg: StepWarning, /) -> str: ...

    def find_problems(self) -> list[StepWarning]: ...

class Targets:
    def __init__(self, arg0: Sequence[ClothId], arg1: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], arg2: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

class Recording:
    def __init__(self, arg0: Sequence[ClothId], arg1: bool, arg2: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None, 3), order='C', device='cpu')], /) -> None: ...

    def copy(self, arg: Batch, /) -> None: ...

class Batch:
    def __init__(self, arg: int, /) -> None: ...

    def add(self, arg: World, /) -> None: ...

    def make_worlds(self) -> None: ...

    def world(self, arg: int, /) -> World: ...

    def step(self, arg0: float, arg1: int, arg2: Sequence[Targets], arg3: Sequence[Recording], /) -> list[StepReport]: ...

    def reset(self, arg: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], /) -> None: ...

class Diagnostic:
    """One mistake in a scene."""

    @property
    def file(self) -> str:
        """Of a changed value: "--set path.to.key\""""

    @property
    def line(self) -> int:
        """From 1; 0: not in a file"""

    @property
    def column(self) -> int:
        """From 1; 0: not in a file"""

    @property
    def message(self) -> str:
        """A sentence"""

    def __str__(self) -> str: ...

    def __repr__(self) -> str: ...

class SceneError(InputError):
    """
    A scene with mistakes; `diagnostics` has file, line, column and message of each.
    """

class Scene:
    @staticmethod
    def load(arg: str, /) -> Scene: ...

    @staticmethod
    def parse(arg0: str, arg1: str, /) -> Scene: ...

    def set(self, arg: str, /) -> None: ...

    def to_json(self) -> str: ...

    def write(self, arg: str, /) -> None: ...

    @property
    def name(self) -> str: ...

    @property
    def frames_per_second(self) -> float: ...

    @property
    def steps_per_frame(self) -> int: ...

    @property
    def num_frames(self) -> int: ...

    @property
    def step(self) -> float: ...

    def copy(self) -> Scene: ...

    def build(self) -> tuple[World, list[str]]: ...

def scene_names() -> list[str]:
    """Names of the shipped scenes, sorted."""

def read_gltf(file: str, node: str, clip: str, scale: float) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], VertexMotion | None, str, list[str]]: ...

def read_obj(file: str) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], tuple[NDArray[numpy.int32], NDArray[numpy.int32], NDArray[numpy.float64], list[tuple[str, bool, NDArray[numpy.int32]]], NDArray[numpy.int32]], list[str]]: ...

def write_obj(arg0: str, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg2: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg3: Annotated[NDArray[numpy.float64], dict(shape=(None, 3, 2), order='C', device='cpu', writable=False)] | None, /) -> None: ...

def write_obj_polygons(file: str, vertices: NDArray[numpy.float64], sizes: NDArray[numpy.int32], corners: NDArray[numpy.int32], uv: NDArray[numpy.float64] | None, groups: list[tuple[str, bool, NDArray[numpy.int32]]], lines: NDArray[numpy.int32], /) -> None: ...

def read_mesh(file: str) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], tuple[NDArray[numpy.int32], NDArray[numpy.int32], NDArray[numpy.float64], list[tuple[str, bool, NDArray[numpy.int32]]], NDArray[numpy.int32]], list[str]]: ...

def write_mesh(arg0: str, arg1: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg2: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], arg3: Annotated[NDArray[numpy.float64], dict(shape=(None, 3, 2), order='C', device='cpu', writable=False)] | None, /) -> None: ...

def write_mesh_polygons(file: str, vertices: NDArray[numpy.float64], sizes: NDArray[numpy.int32], corners: NDArray[numpy.int32], uv: NDArray[numpy.float64] | None, groups: list[tuple[str, bool, NDArray[numpy.int32]]], lines: NDArray[numpy.int32], /) -> None: ...

def triangulate(corners: NDArray[numpy.float64], counts: NDArray[numpy.int32]) -> NDArray[numpy.int32]: ...

def vertex_normals(triangles: NDArray[numpy.int32], positions: NDArray[numpy.float32]) -> NDArray[numpy.float32]: ...

def rest_from_uv(vertices: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], faces: Annotated[NDArray[numpy.int32], dict(shape=(None, 3), order='C', device='cpu', writable=False)], uv: Annotated[NDArray[numpy.float64], dict(shape=(None, 3, 2), order='C', device='cpu', writable=False)] | None, scale: float | None) -> NDArray[numpy.float64]: ...

class PointCacheFile:
    def __init__(self, arg: str, /) -> None: ...

    @property
    def num_points(self) -> int: ...

    @property
    def num_frames(self) -> int: ...

    @property
    def times(self) -> list[float]: ...

    def frame(self, k: int) -> NDArray[numpy.float32]: ...

class PointCacheWriter:
    def __init__(self, arg0: str, arg1: int, arg2: Sequence[float], /) -> None: ...

    def add_frame(self, positions: NDArray[numpy.float32]) -> None: ...

    def finish(self) -> None: ...

def convert(file: str, out: str, fps: float | None, up_is_z: bool, scale: float, first_frame: int, last_frame: int | None, mesh: str) -> tuple[list[str], list[str]]: ...

def find_crossings(surfaces: Sequence[tuple[NDArray[numpy.float64], NDArray[numpy.int32], bool]]) -> list[list[int]]: ...

def run(scene: Scene, frames: int | None, threads: int, audit: bool, check_passages: bool, folder: str, glb: bool, obj: bool, start_from: str, unfinished: str, checkpoint_every: int | None, on_frame: Callable[[int, int, float, float], object] | None) -> dict[str, Any]: ...

class GraphicsError(RuntimeError):
    """
    There is no EGL or OpenGL 3.3 for pictures in colour; the message says what to install.
    """

class RenderOptions:
    def __init__(self, arg0: bool, arg1: bool, arg2: int, arg3: Sequence[Sequence[float]], arg4: float | None, arg5: int | None, /) -> None: ...

class CameraValues:
    def __init__(self, arg0: Sequence[float], arg1: Sequence[float], arg2: float, arg3: int, arg4: int, /) -> None: ...

    @property
    def position(self) -> tuple[float, float, float]: ...

    @property
    def target(self) -> tuple[float, float, float]: ...

    @property
    def fov_deg(self) -> float: ...

    @property
    def width(self) -> int: ...

    @property
    def height(self) -> int: ...

class AnimationFile:
    def __init__(self, arg: str, /) -> None: ...

    @property
    def num_frames(self) -> int: ...

@overload
def frame_camera(arg0: World, arg1: CameraValues, /) -> CameraValues: ...

@overload
def frame_camera(arg0: AnimationFile, arg1: CameraValues, /) -> CameraValues: ...

class Renderer:
    def __init__(self) -> None: ...

    def render(self, world: World, camera: CameraValues, options: RenderOptions) -> tuple[NDArray[numpy.uint8], NDArray[numpy.float32], NDArray[numpy.int32]]: ...

    def render_frame(self, animation: AnimationFile, frame: int, camera: CameraValues, options: RenderOptions) -> tuple[NDArray[numpy.uint8], NDArray[numpy.float32], NDArray[numpy.int32]]: ...

def write_picture(arg0: str, arg1: Annotated[NDArray[numpy.uint8], dict(shape=(None, None, 3), order='C', device='cpu', writable=False)], /) -> None: ...

def write_video(arg0: str, arg1: AnimationFile, arg2: CameraValues, arg3: RenderOptions, arg4: int, /) -> None: ...
