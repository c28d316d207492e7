"""The springs of the Maxwell-slip law in the memory of the plant."""

from furuta_model.compiled import inlined
from furuta_model.friction.laws import FrictionLaw, sliding_level
from furuta_model.friction.maxwell_slip import slip_deflection, stretched
from furuta_model.parts.plant_memory import MotorMemory, PlantMemory

# Whose springs: those of the arm, or those of its motor.
SpringMemory = PlantMemory | MotorMemory


@inlined
def springs_force(
    memory: SpringMemory, v: float, h: float, springs: int, law: FrictionLaw
) -> tuple[float, float]:
    """Mean friction [V] of the springs over ``h`` [s] at speed v [rad/s], without viscous part.

    Exact for constant v. Also returns their mean deflection at the end [rad]; the deflections are
    kept for :func:`keep_springs`.
    """
    p = law.parameters
    level = sliding_level(v, v, law)
    end = mean = 0.0
    for i in range(springs):
        slip = slip_deflection(i, springs, level, p)
        memory.next_springs[i], mean_deflection = stretched(memory.springs[i], v * h, slip)
        end += memory.next_springs[i]
        mean += mean_deflection
    return p.sigma0 * mean / springs, end / springs


@inlined
def keep_springs(memory: SpringMemory, springs: int) -> None:
    """Take the deflections that :func:`springs_force` computed last."""
    for i in range(springs):
        memory.springs[i] = memory.next_springs[i]


@inlined
def springs_friction(memory: SpringMemory, v: float, springs: int, law: FrictionLaw) -> float:
    """Friction [V] of the springs at speed v [rad/s], without viscous part."""
    p = law.parameters
    level = sliding_level(v, v, law)
    force = 0.0
    for i in range(springs):
        z, slip = memory.springs[i], slip_deflection(i, springs, level, p)
        if v > 0.0:
            z = min(z, slip)
        elif v < 0.0:
            z = max(z, -slip)
        force += p.sigma0 * z
    return force / springs
