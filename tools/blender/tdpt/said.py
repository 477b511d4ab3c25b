"""What an export has to tell: what it changed, and what is lost. Blender's exporter prints hundreds of lines, so these are
kept and come at the end."""

LINES = []


def say(text):
    if text not in LINES:
        LINES.append(text)
