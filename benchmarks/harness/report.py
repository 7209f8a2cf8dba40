"""The table of a run of the bench, and the test of the means."""

from statistics import fmean

from . import estimation

# Probability that any of all the tests of means in a run fails although all means agree.
LEVEL_OF_ALL = 0.01

# Width of a column of figures with intervals: the longest, 1.23e+03 [1.23e+03, 1.23e+03], and two spaces.
WITH_INTERVAL = 31


def group(measurements):
    """Measurements that did not fail, by (scene, renderer), each sorted into its numbers of samples."""
    groups = {}
    for one in measurements:
        if "failed" not in one:
            groups.setdefault((one["scene"], one["renderer"]), {}).setdefault(one["spp"], []).append(one)
    return groups


def rows(measurements, scenes, clock):
    """A row of figures for each scene and renderer, of its largest number of samples, in the order they were measured.

    `clock` is `wall`, or `cpu`: the seconds of all threads over their number, on a machine that has other work.
    """
    groups = group(measurements)
    ours = {}
    for (letter, renderer), by_samples in groups.items():
        if renderer == "tyndall":
            ours[letter] = efficiencies(by_samples[max(by_samples)], scenes[letter], clock)
    tests = 3 * len(groups)
    for (letter, renderer), by_samples in sorted(groups.items(), key=lambda entry: entry[0][0]):
        scene, taken = scenes[letter], by_samples[max(by_samples)]
        values = efficiencies(taken, scene, clock)
        noise = scene.noise
        z = [
            estimation.mean_agreement(
                [one["mean_difference"][c] for one in taken],
                [one["standard_error"][c] for one in taken],
                [one["relmse"] for one in taken],
                noise,
                taken[0]["reference_mean"][c],
                scene.allowance(renderer),
            )
            for c in range(3)
        ]
        yield {
            "scene": letter,
            "renderer": renderer,
            "spp": taken[0]["spp"],
            "seeds": len(taken),
            "seconds": fmean(seconds(one, clock) for one in taken),
            "relmse": fmean(one["relmse"] - noise for one in taken),
            "trimmed": fmean(one["relmse_trimmed"] - noise for one in taken),
            "efficiency": estimation.geometric_mean(values) if values else None,
            "ratio": estimation.ratio(ours[letter], values) if values and ours.get(letter) else None,
            "offset": [fmean(o["mean_difference"][c] for o in taken) / taken[0]["reference_mean"][c] for c in range(3)],
            "z": z,
            "agrees": max(z) <= estimation.critical_z(LEVEL_OF_ALL, tests),
            "failures": sum(one["non_finite"] + one["negative"] for one in taken),
        }


def seconds(one, clock):
    """Time of a measurement on the chosen clock."""
    return one["seconds"] if clock == "wall" else one["cpu_seconds"] / one["threads"]


def efficiencies(taken, scene, clock):
    """Efficiency for each seed; empty if one cannot be told from the reference's noise."""
    values = [estimation.efficiency(one["relmse"], scene.noise, seconds(one, clock)) for one in taken]
    return [] if None in values else values


def table(all_rows, labels, clock):
    """The rows as text."""
    lines = [
        f"{'':6}{'renderer':18}{'spp':>5}{'seeds':>6}{clock + ' s':>9}{'relMSE':>11}{'(trimmed)':>12}"
        f"{'efficiency [95 %]':>{WITH_INTERVAL}}{'Tyndall / it [95 %]':>{WITH_INTERVAL}}   offset of the mean"
    ]
    for row in all_rows:
        offset = ",".join(f"{100 * value:+.2f}" for value in row["offset"])
        verdict = "" if row["agrees"] else f"  MEANS DIFFER, z {max(row['z']):.1f}"
        odd = f"  {row['failures']} negative or infinite pixels" if row["failures"] else ""
        ratio = row["ratio"] if row["renderer"] != "tyndall" else None
        lines.append(
            f"{row['scene']:6}{labels[row['renderer']]:18}{row['spp']:5}{row['seeds']:6}{row['seconds']:9.3g}"
            f"{row['relmse']:11.3e}{row['trimmed']:12.3e}{with_interval(row['efficiency']):>{WITH_INTERVAL}}"
            f"{with_interval(ratio):>{WITH_INTERVAL}}   {offset} %{verdict}{odd}"
        )
    return "\n".join(lines)


def with_interval(value):
    """`value [low, high]`."""
    if value is None:
        return "-"
    mean, low, high = value
    return f"{mean:.3g}" if low is None else f"{mean:.3g} [{low:.3g}, {high:.3g}]"


def best_peers(all_rows, labels):
    """A line for each scene that was rendered by us and a peer."""
    for letter in sorted({row["scene"] for row in all_rows}):
        others = [row for row in all_rows if row["scene"] == letter and row["renderer"] != "tyndall" and row["ratio"]]
        if others:
            best = max(others, key=lambda row: row["efficiency"][0])
            yield f"{letter}: {with_interval(best['ratio'])} times the efficiency of {labels[best['renderer']]}, the best peer"
