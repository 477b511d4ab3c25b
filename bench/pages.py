"""Tables in Markdown, numbers as tables have them, and plots as text for gnuplot."""
import csv
import json
import math
import re
import subprocess


def hundredths(x):
    if x is None or not math.isfinite(x):
        return "-"
    return "%.2f" % x if x < 9.95 else "%.1f" % x if x < 99.5 else "%.0f" % x


def three(x):
    """Three digits."""
    return "-" if x is None or not math.isfinite(x) else "%.3g" % x


def row(*cells):
    return "|" + "|".join(f" {c} " for c in cells) + "|"


def table(heads, rows):
    """Text without a newline at its end."""
    return "\n".join([row(*heads), "|---" * len(heads) + "|", *(row(*cells) for cells in rows)])


def sections(*parts):
    """Paragraphs and tables with an empty line between; what is empty is left out."""
    return "\n\n".join(part.strip("\n") for part in parts if part)


def filled(text, parts, name, measured):
    """A page with its parts, between <!-- PART --> and <!-- end -->, and the line that tells how benchmark `name`
    measured. Throws ValueError where one is missing."""
    for part, words in {**parts, "": measured}.items():
        where = rf"(<!-- {re.escape(part)} -->\n).*?(<!-- end -->)" if part else \
            rf"()^\*Measured by `make bench-{name}[ `].*$()"
        text, found = re.subn(where, lambda m, words=words: f"{m[1]}{words.strip()}{m[2] and chr(10)}{m[2]}", text,
                              flags=re.S | re.M if part else re.M)
        if found != 1:
            raise ValueError(f"the page has {found} places for {part or 'how ' + name + ' measured'}, expected 1")
    return text


def write_csv(path, rows):
    """rows: dictionaries of the same fields."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        file = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        file.writeheader()
        file.writerows({k: "%.6g" % v if isinstance(v, float) else v for k, v in row.items()} for row in rows)


def read_json(path):
    return json.loads(path.read_text(encoding="utf-8"))


def draw(script, folder, name="plot"):
    """gnuplot makes in FOLDER what the script names."""
    path = folder / f"{name}.gnuplot"
    path.write_text(script, encoding="utf-8")
    subprocess.run(["gnuplot", path.name], check=True, cwd=folder)
    path.unlink()


def label(text):
    """A text that is drawn, in which an underscore would lower the next letter."""
    return '"%s"' % text.replace("_", r"\\_")


class Figure:
    """Panels in rows. Each: title, words of the axes, lines, marks."""

    def __init__(self, columns, width=400, height=320):
        self.columns, self.width, self.height, self.panels, self.data = columns, width, height, [], []

    def block(self, rows):
        """Rows of numbers, as a named block of the script."""
        name = "$d%d" % len(self.data)
        self.data.append("%s << EOD\n%s\nEOD\n" % (name, "\n".join(" ".join(map("%.6g".__mod__, row)) for row in rows)))
        return name

    def panel(self, title, x, y, plots, settings=()):
        self.panels.append(["set title %s offset 0,-0.6" % label(title), "set xlabel %s offset 0,0.4" % label(x),
                            "set ylabel %s offset 1,0" % label(y), *settings,
                            "plot " + ", \\\n  ".join(plots) if plots else "plot NaN notitle"])

    def key(self, plots):
        """A panel that holds the key alone."""
        self.panels.append(
            ["unset title", "unset xlabel", "unset ylabel", "unset logscale", "unset xtics", "unset ytics",
             "unset border", "unset grid", "set key center center spacing 1.4 samplen 3 Left reverse",
             "plot [1:2] [1:2] " + ", ".join(plots)])

    def script(self, output):
        columns = min(self.columns, len(self.panels))
        lines = -(-len(self.panels) // columns)
        head = ['set terminal pngcairo size %d,%d font "sans-serif,12" background "white"' %
                (columns * self.width, lines * self.height), 'set output "%s"' % output,
                "set multiplot layout %d,%d" % (lines, columns)]
        common = ['set grid lc rgb "#dddddd" lt 1 lw 0.5', "set border lw 1", "set key off", "set pointsize 1.1",
                  "set bars 0.6", "set lmargin 9", "set rmargin 2", "set tmargin 2.2", "set bmargin 3.5",
                  'set format x "%g"', 'set format y "%g"']
        body = [line for panel in self.panels for line in ("reset", *common, *panel)]
        return "".join(self.data) + "\n".join(head + body + ["unset multiplot"]) + "\n"
