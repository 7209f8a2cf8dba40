"""Efficiency with its confidence interval, ratios of efficiencies, slopes in log-log, and whether means agree.

The efficiency of one render is e = 1 / ((relMSE - own noise of the reference) * seconds). Over seeds log e is taken for
normal, with an unknown variance: its mean has Student's t interval, and the ratio of two renderers, the difference of
two such means, Welch's (Welch 1947, Biometrika 34; Satterthwaite's degrees of freedom). What all renders share, as the
stated noise of the reference, is not in the intervals. Nothing but the standard library is needed here.
"""

import math


def student_quantile(probability, freedom):
    """The x below which Student's t with `freedom` > 0 (not only whole) degrees of freedom lies with `probability`."""
    if probability < 0.5:
        return -student_quantile(1.0 - probability, freedom)
    low, high = 0.0, 1.0
    while student_cdf(high, freedom) < probability:
        high *= 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if student_cdf(middle, freedom) < probability else (low, middle)
    return 0.5 * (low + high)


def student_cdf(x, freedom):
    """P(t <= x), through the regularised incomplete beta function (Abramowitz and Stegun 26.7.1, 26.5.8)."""
    tail = 0.5 * incomplete_beta(0.5 * freedom, 0.5, freedom / (freedom + x * x))
    return 1.0 - tail if x > 0.0 else tail


def incomplete_beta(a, b, x):
    """I_x(a, b) by its continued fraction (Abramowitz and Stegun 26.5.8), evaluated by Lentz's method."""
    if x <= 0.0 or x >= 1.0:
        return min(max(x, 0.0), 1.0)
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - incomplete_beta(b, a, 1.0 - x)
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    tiny = 1e-300
    c, d = 1.0, 1.0 / max(1.0 - (a + b) * x / (a + 1.0), tiny)
    fraction = d
    for m in range(1, 500):
        for term in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1.0 + term * d
            c = 1.0 + term / c
            d = 1.0 / (d if abs(d) > tiny else tiny)
            c = c if abs(c) > tiny else tiny
            fraction *= c * d
        if abs(c * d - 1.0) < 1e-15:
            break
    return front * fraction


def normal_quantile(probability):
    """The x below which a standard normal variable lies with `probability`."""
    from statistics import NormalDist

    return NormalDist().inv_cdf(probability)


def mean_and_variance(values):
    """Mean, and variance of the mean; the latter is NaN for a single value."""
    mean = math.fsum(values) / len(values)
    if len(values) < 2:
        return mean, math.nan
    return mean, math.fsum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values)


def efficiency(relmse, noise, seconds):
    """1/s; None where the error does not stand out of the reference's own noise by at least as much again."""
    error = relmse - noise
    return 1.0 / (error * seconds) if error > noise and seconds > 0.0 else None


def geometric_mean(values, level=0.95):
    """Geometric mean of positive values and its log-normal interval, (mean, low, high); without ends for one value."""
    mean, variance = mean_and_variance([math.log(v) for v in values])
    if len(values) < 2:
        return math.exp(mean), None, None
    reach = student_quantile(0.5 + 0.5 * level, len(values) - 1) * math.sqrt(variance)
    return math.exp(mean), math.exp(mean - reach), math.exp(mean + reach)


def ratio(ours, theirs, level=0.95):
    """Ratio of the geometric means of two independent sets of positive values, with Welch's interval."""
    (a, va), (b, vb) = (mean_and_variance([math.log(v) for v in values]) for values in (ours, theirs))
    if len(ours) < 2 or len(theirs) < 2:
        return math.exp(a - b), None, None
    spread = va + vb
    if spread == 0.0:
        return (math.exp(a - b),) * 3
    freedom = spread**2 / (va**2 / (len(ours) - 1) + vb**2 / (len(theirs) - 1))
    reach = student_quantile(0.5 + 0.5 * level, freedom) * math.sqrt(spread)
    return math.exp(a - b), math.exp(a - b - reach), math.exp(a - b + reach)


def exponent(x, y, level=0.95):
    """Slope of log y over log x by least squares, with Student's interval; without ends for two points."""
    u, v = [math.log(value) for value in x], [math.log(value) for value in y]
    n, mean_u, mean_v = len(u), math.fsum(u) / len(u), math.fsum(v) / len(v)
    spread = math.fsum((a - mean_u) ** 2 for a in u)
    slope = math.fsum((a - mean_u) * (b - mean_v) for a, b in zip(u, v)) / spread
    if n < 3:
        return slope, None, None
    residue = math.fsum((b - mean_v - slope * (a - mean_u)) ** 2 for a, b in zip(u, v))
    reach = student_quantile(0.5 + 0.5 * level, n - 2) * math.sqrt(residue / (n - 2) / spread)
    return slope, slope - reach, slope + reach


def mean_agreement(differences, standard_errors, relmse, noise, reference_mean, allowance):
    """z of a channel's mean over several pictures against the reference, once an allowed relative offset is taken off.

    `differences` are the means of I - R, one a picture, `standard_errors` what their pixels say of each, `relmse` what
    was measured and `noise` the reference's share in it. The pictures are independent but for the reference, whose
    share of the variance does not shrink with their number.
    """
    n = len(differences)
    share = min(noise / (math.fsum(relmse) / n), 1.0)
    single = math.fsum(s * s for s in standard_errors) / n
    error = math.sqrt(single * ((1.0 - share) / n + share))
    beyond = max(abs(math.fsum(differences) / n) - allowance * abs(reference_mean), 0.0)
    return beyond / error if error > 0.0 else (math.inf if beyond > 0.0 else 0.0)


def critical_z(level, tests):
    """|z| that any of `tests` two-sided tests passes with probability `level` at most (Bonferroni)."""
    return normal_quantile(1.0 - 0.5 * level / max(tests, 1))
