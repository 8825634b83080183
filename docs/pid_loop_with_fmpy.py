"""The PID loop of the lead experiment's Figure 11 as a script on FMPy, numpy and matplotlib:

    python docs/pid_loop_with_fmpy.py PLANT.fmu GENERATOR.fmu FOLDER [--samples FILE.csv]

It is what one writes without this harness: two coupled FMUs (FMI 3), noise and a quantised sensor,
a discrete PID, rows as CSV and two pictures. `fmu-harness build hybrid_actuator
disturbance_generator` makes the FMUs. Its rows are those of `fmu-harness run ahn2009/figure_11
--variant pid` where it is given the same random samples (columns disturbance, noise).
"""

import argparse
import csv
import math
import shutil
from pathlib import Path

import matplotlib
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STEP, STEPS = 0.01, 1000
COLUMNS = ("time", "reference", "measured", "force", "u", "position", "environment")


class Participant:
    """An FMU in co-simulation whose variables are called by name."""

    def __init__(self, path: Path) -> None:
        description = read_model_description(path)
        self.folder = extract(path)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.fmu = FMU3Slave(
            guid=description.guid, unzipDirectory=self.folder, instanceName=path.stem,
            modelIdentifier=description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.fmu.instantiate()
        self.fmu.enterInitializationMode(startTime=0.0, stopTime=STEPS * STEP)

    def get(self, *names: str) -> list[float]:
        """The values of variables."""
        return self.fmu.getFloat64([self.references[name] for name in names])

    def set(self, **values: float) -> None:
        """Set variables."""
        self.fmu.setFloat64([self.references[name] for name in values], list(values.values()))

    def close(self) -> None:
        """End it and remove what was unpacked."""
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder)


class PID:
    """Trapezoidal integral, filtered derivative, conditional anti-windup."""

    kp, ki, kd, filter_time, low, high = 6.5e-5, 1.1e-4, 3.9e-7, 0.02, -1.0, 1.0

    def __init__(self) -> None:
        self.integral = self.derivative = 0.0
        self.last: float | None = None

    def step(self, reference: float, measured: float) -> float:
        """The control at one sample."""
        error, increment = reference - measured, 0.0
        if self.last is not None:
            alpha = math.exp(-STEP / self.filter_time)
            increment = STEP * (0.5 * error + 0.5 * self.last)
            slope = (error - self.last) / STEP
            self.derivative = alpha * self.derivative + (1.0 - alpha) * slope
        self.last = error
        others = self.kp * error, self.kd * self.derivative

        def wanted(integral: float) -> float:
            return others[0] + self.ki * integral + others[1]

        unlimited = wanted(self.integral + increment)
        excess = unlimited - min(max(unlimited, self.low), self.high)
        if excess * self.ki * increment <= 0.0:
            self.integral += increment
        return min(max(wanted(self.integral), self.low), self.high)


def simulate(plant: Participant, generator: Participant, disturbance, noise) -> np.ndarray:
    """The rows of a run, one a sample."""
    pid, rows = PID(), np.empty((STEPS + 1, len(COLUMNS)))
    for k in range(STEPS + 1):
        t = k * STEP
        place, velocity = generator.get("environment_position", "environment_velocity")
        plant.set(environment_position=place, environment_velocity=velocity)
        # only now: the force of the spring depends on the position without delay
        force, spring_force, position = plant.get("force", "spring_force", "position")
        reference = 2000.0 if t >= 0.1 else 0.0
        measured = float(np.round(force + noise[k]))
        u = pid.step(reference, measured)
        rows[k] = t, reference, measured, force, u, position, place
        plant.set(command=u)
        generator.set(command=disturbance[k], spring_force=spring_force)
        if k == 0:
            plant.fmu.exitInitializationMode()
            generator.fmu.exitInitializationMode()
        if k < STEPS:
            for one in (plant, generator):
                one.fmu.doStep(currentCommunicationPoint=t, communicationStepSize=STEP)
    return rows


def random_samples(file: Path | None) -> tuple[np.ndarray, np.ndarray]:
    """Disturbance, eq. (50), and noise of the sensor (N), shape (STEPS + 1,)."""
    if file is not None:
        return tuple(np.loadtxt(file, delimiter=",", skiprows=1).T)
    rng, t = np.random.default_rng(1), STEP * np.arange(STEPS + 1)
    disturbance = 0.05 * np.sin(2.0 * np.pi * 0.5 * t) + 0.1 * rng.standard_normal(STEPS + 1)
    return disturbance, 5.0 * rng.standard_normal(STEPS + 1)


def draw(rows: np.ndarray, folder: Path) -> None:
    """Response, error and control; what the disturbance generator does."""
    column = dict(zip(COLUMNS, rows.T, strict=True))
    t = column["time"]
    figure, (above, middle, below) = plt.subplots(3, 1, sharex=True, figsize=(8, 8))
    above.plot(t, column["force"], label="force")
    above.step(t, column["reference"], "k--", where="post", label="reference")
    middle.plot(t, column["reference"] - column["force"])
    below.step(t, column["u"], where="post")
    for axes, label in ((above, "force in N"), (middle, "error in N"), (below, "u")):
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    above.legend()
    below.set_xlabel("time in s")
    figure.savefig(folder / "response.png", dpi=110)
    figure, axes = plt.subplots(figsize=(8, 4))
    axes.plot(t, column["environment"], label="environment")
    axes.plot(t, column["position"], label="rod")
    axes.set(xlabel="time in s", ylabel="position in m")
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(folder / "disturbance.png", dpi=110)


def main() -> None:
    """Simulate, write the rows, draw."""
    parser = argparse.ArgumentParser()
    parser.add_argument("plant", type=Path)
    parser.add_argument("generator", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--samples", type=Path)
    given = parser.parse_args()
    plant, generator = Participant(given.plant), Participant(given.generator)
    rows = simulate(plant, generator, *random_samples(given.samples))
    plant.close()
    generator.close()
    given.folder.mkdir(parents=True, exist_ok=True)
    with (given.folder / "results.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(rows.tolist())
    draw(rows, given.folder)
    error = rows[600:, COLUMNS.index("reference")] - rows[600:, COLUMNS.index("force")]
    print(f"RMS of the error after 6 s: {np.sqrt(np.mean(error**2)):.1f} N")


if __name__ == "__main__":
    main()
