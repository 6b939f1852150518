#!/usr/bin/env python3
"""The hung sheet of `weft study peers` in MuJoCo: a flex of triangles with an isotropic membrane, no contact.

mujoco_sheet.py SIDE STEPS INTEGRATOR FRAMES FILE

SIDE particles a side of a square metre, STEPS per frame of 1/60 s, MuJoCo's integrator (discrete or Euler). Writes x y z
of all particles by turns as 32-bit floats (frame by frame, y up, the row of pins first) to FILE, and prints one line of
JSON: {"engine": "MuJoCo 4.0.0", "cpu_ms_per_frame": 10.4}.
"""

import sys

import mujoco
import numpy
from measure import measure

DENSITY = 0.2  # kg/m²
STIFFNESS = 8000 / 3  # Young's modulus times thickness, N/m: C11 = 3000, C12 = G = 1000
THICKNESS = 1e-3  # m; only its product with Young's modulus matters without bending


def build_model(side, steps, integrator):
    spacing = 1 / (side - 1)
    # A grid lies in x and y, with y running along the columns first: particle i * side + j is at (i, j).
    pins = f"0 {side * (side - 1)}"
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{1 / 60 / steps}" gravity="0 0 -9.81" integrator="{integrator}"><flag contact="disable"/></option>
  <worldbody>
    <flexcomp name="sheet" type="grid" dim="2" count="{side} {side} 1" spacing="{spacing} {spacing} 1"
              mass="{DENSITY}" radius="0.001">
      <elasticity young="{STIFFNESS / THICKNESS}" poisson="0.3333333" thickness="{THICKNESS}" elastic2d="stretch"/>
      <edge equality="false" damping="0"/>
      <contact selfcollide="none"/>
      <pin id="{pins}"/>
    </flexcomp>
  </worldbody>
</mujoco>""")


class Sheet:
    def __init__(self, model, side, steps):
        self.model, self.side, self.steps = model, side, steps
        self.data = mujoco.MjData(model)

    def advance_frame(self):
        for _ in range(self.steps):
            mujoco.mj_step(self.model, self.data)

    def positions(self):
        """Columns become rows, the sheet's corner the origin, z up y up."""
        mujoco.mj_forward(self.model, self.data)  # else they are those before the last step
        x = self.data.flexvert_xpos.reshape(self.side, self.side, 3).transpose(1, 0, 2)
        return numpy.stack([x[..., 0] + 0.5, x[..., 2], x[..., 1] + 0.5], axis=-1).astype("<f4")


def main():
    side, steps, integrator, frames = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    mujoco.set_mju_user_warning(lambda words: print(words, file=sys.stderr))  # not into a file where it was started
    model = build_model(side, steps, integrator)
    measure("MuJoCo " + mujoco.__version__, lambda: Sheet(model, side, steps), frames, sys.argv[5])


main()
