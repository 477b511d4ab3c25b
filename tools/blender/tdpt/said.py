"""What an export has to tell, the worst first: what is lost of the light, of the look of one thing, and what was merely
done. Blender's exporter prints hundreds of lines, so these are kept and come at the end."""

LIGHT, LOOK, NOTE = "light", "look", "note"  # the light of the whole picture differs; one thing looks otherwise; nothing is lost
LINES = {LIGHT: [], LOOK: [], NOTE: []}


def say(harm, text):
    if text not in LINES[harm]:
        LINES[harm].append(text)


def lines():
    return [f"{harm}: {text}" for harm, texts in LINES.items() for text in texts]
