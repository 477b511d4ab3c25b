"""Means, errors and intervals of a few measurements; every function is one formula."""
import functools
import math
from dataclasses import dataclass

import numpy as np

DRAWS = 10000  # of a bootstrap
SEED = 20240229  # of its random numbers
NO_BOUND = 1e9  # a ratio whose divisor is not positive


def mean_and_error(values):
    """Mean and its standard error over axis 0."""
    return values.mean(0), values.std(0, ddof=1) / np.sqrt(len(values))


def in_errors(a, b):
    """Difference of two (mean, error) in units of its standard error; 0 where both are constant and equal."""
    difference, error = a[0] - b[0], np.hypot(a[1], b[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(difference == 0, 0.0, difference / error)


def weighted_mean(values, weights):
    """Mean of pictures' means, weights: their samples per pixel; and the variance of one of weight 1."""
    mean = np.average(values, weights=weights)
    return mean, np.sum(weights * (values - mean) ** 2) / (len(values) - 1) if len(values) > 1 else 0.0


def normal_tail(x):
    """Probability of more than x standard deviations."""
    return 0.5 * math.erfc(x / math.sqrt(2))


def t_tail(t, df):
    """Probability of more than t > 0 under Student's distribution with df = 1, 2, ... degrees of freedom
    (Abramowitz and Stegun 26.7.3, 26.7.4)."""
    angle, odd = math.atan(t / math.sqrt(df)), df % 2
    c = math.cos(angle)
    term = total = c if odd else 1.0
    for k in range(2 + odd, df - 1, 2):
        term *= c * c * (k - 1) / k
        total += term
    inside = math.sin(angle) * total if df > 1 else 0
    return (1 - (2 / math.pi * (angle + inside) if odd else inside)) / 2


@functools.cache
def t_quantile(tail, df):
    """The t > 0 with t_tail(t, df) = tail, by bisection."""
    low, high = 0.0, 1.0
    while t_tail(high, df) > tail:
        high *= 2
    while high - low > 1e-12 * high:
        middle = (low + high) / 2
        low, high = (middle, high) if t_tail(middle, df) > tail else (low, middle)
    return (low + high) / 2


@dataclass
class Ratio:
    """A measured ratio or share and the ends of its 95 % interval; nan where they are not known."""

    value: float = math.nan
    low: float = math.nan
    high: float = math.nan

    def text(self, form, unbounded="-"):
        """VALUE [LOW, HIGH], as form says numbers."""
        if not math.isfinite(self.value):
            return "-"
        if not math.isfinite(self.low):
            return form(self.value)
        return f"{form(self.value)} [{form(self.low)}, {unbounded if self.high >= NO_BOUND else form(self.high)}]"


def interval(pairs, rng, tail=None):
    """Ends of the 95 % interval of the geometric mean of mean(above) / mean(below) by bootstrap, pairs: of (above,
    below), each drawn from by itself; 0 or NO_BOUND where draws are not positive. tail: share beyond each end; if not
    given, percentiles widened to the t distribution (Hesterberg, "What Teachers Should Know About the Bootstrap", 2015:
    expanded percentiles)."""
    draws, n = [], min(len(v) for pair in pairs for v in pair)
    for pair in pairs:
        above, below = (v[rng.integers(len(v), size=(DRAWS, len(v)))].mean(1) for v in pair)
        with np.errstate(divide="ignore", invalid="ignore"):
            draws.append(np.where(below <= 0, NO_BOUND, np.maximum(above, 0) / below))
    means = np.prod(draws, axis=0) ** (1 / len(draws))
    means[np.max(draws, axis=0) >= NO_BOUND] = NO_BOUND
    means.sort()
    level = int((tail or normal_tail(math.sqrt(n / (n - 1)) * t_quantile(0.025, n - 1))) * DRAWS)
    return means[level], means[DRAWS - 1 - level]


def geometric(pairs, seed=SEED):
    """Geometric mean of the ratios of the means of pairs of samples (above, below); nan where one mean is not positive,
    as an error is that hides in a reference's noise. Of single values no interval."""
    pairs = [tuple(np.asarray(v, float) for v in pair) for pair in pairs]
    if not pairs or any(not len(v) or v.mean() <= 0 for pair in pairs for v in pair):
        return Ratio()
    value = math.prod(a.mean() / b.mean() for a, b in pairs) ** (1 / len(pairs))
    if min(len(v) for pair in pairs for v in pair) < 2:
        return Ratio(value)
    return Ratio(value, *interval(pairs, np.random.default_rng(seed)))


def ratio(above, below, seed=SEED):
    """Of two means."""
    return geometric([(above, below)], seed)


def wilson(hits, of):
    """Share of hits with its 95 % interval (Wilson's, which holds for few and for all)."""
    if not of:
        return Ratio()
    z = 1.96
    p, below = hits / of, 1 + z * z / of
    middle, half = (p + z * z / (2 * of)) / below, z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of)) / below
    return Ratio(p, max(0.0, middle - half), min(1.0, middle + half))
