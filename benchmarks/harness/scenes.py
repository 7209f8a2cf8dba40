"""The bench's scenes: files, references, and how far means may lie apart.

What the scenes are stands in README.md beside this folder; the reference pictures, their noise and the offsets that
are known, in ../shared/bench/references/README.md beside the checkout.
"""

from dataclasses import dataclass, field

from .environment import BENCHMARKS, SHARED

# Two independent renderers agree to this on scenes where nothing is known to differ.
AGREEMENT = 0.0015


@dataclass(frozen=True)
class Scene:
    """One scene of the bench."""

    letter: str
    name: str
    # relMSE of the reference picture by its own noise, which is part of every relMSE measured against it.
    noise: float
    # Relative offset of the mean from the reference's that is known, by renderer; "" stands for all others.
    allowances: dict = field(default_factory=dict)

    @property
    def file(self):
        return BENCHMARKS / "scenes" / f"{self.letter}_{self.name}.toml"

    @property
    def reference(self):
        return SHARED / "bench" / "references" / f"{self.letter}.exr"

    def allowance(self, renderer):
        """Relative offset of the mean that is accepted before z is taken."""
        return self.allowances.get(renderer, self.allowances.get("", AGREEMENT))


SCENES = [
    # Cycles ends the series that removes the bias of its transmittance early: 1 to 2 % too bright on dense clouds.
    Scene("A", "cloud", 8.2e-4, {"cycles": 0.015}),
    Scene("B", "smoke", 4.6e-5),
    # The reference itself is about 0.45 % too bright; pbrt's coloured walls differ through its RGB to spectrum step.
    Scene("C", "fogbox", 5.8e-4, {"": 0.006, "pbrt": 0.1}),
    Scene("D", "fire", 2.0e-4, {"pbrt": 0.003}),
    Scene("E", "milk", 1.8e-4, {"pbrt": 0.01}),
    Scene("G", "wdas", 1.2e-3, {"cycles": 0.025, "": 0.003}),
]


def chosen(letters):
    """The scenes of these letters, in the order of the table."""
    unknown = set(letters) - {scene.letter for scene in SCENES}
    if unknown:
        raise SystemExit(f"--scenes {''.join(sorted(unknown))}: there are {''.join(s.letter for s in SCENES)}")
    return [scene for scene in SCENES if scene.letter in letters]
