"""How far a picture is from what it converges to, as exrdiff says it, by a reference in two halves A, B of different seeds:
(x - A)(x - B) stands for the square of x's error, since the noise of neither half is in it on average."""
import numpy as np

import exr_file


class Reference:
    """r: mean of the halves; the squares that relMSE divides by hold their noise, which makes it too small by about as much
    as the reference's own relMSE."""

    def __init__(self, a, b):
        self.a, self.b, self.r = a, b, (a + b) / 2
        self.mean = np.abs(self.r).mean()
        self.below = self.r**2 + 0.01 * self.mean**2
        self.peak = np.abs(self.r).max()

    @classmethod
    def read(cls, stem):
        return cls(*(exr_file.read(f"{stem}-{half}.exr")[0] for half in (1, 2)))

    def measures(self, x):
        """relmse, mse, psnr [dB], mape [%], mean of picture x. mape holds the reference's noise."""
        square = (x - self.a) * (x - self.b)
        mse = square.mean()
        return {"relmse": (square / self.below).mean(), "mse": mse,
                "psnr": 10 * np.log10(self.peak**2 / mse) if mse > 0 else float("inf"),
                "mape": 100 * (np.abs(x - self.r) / (np.abs(self.r) + 0.01 * self.mean)).mean(), "mean": x.mean()}

    def black(self):
        return self.measures(np.zeros_like(self.r))

    def noise(self):
        """relMSE of the reference itself: a quarter of the halves' distance."""
        return ((self.a - self.b) ** 2 / 4 / self.below).mean()
