"""What trades speed for accuracy: every knob of the chain with the values that its curve has, and the scenes that
curves are measured on. Data alone."""
from dataclasses import dataclass

STAGES = ("ffgraph", "mincut", "lightgrid", "portalfit")
CHAIN = "the four stages"  # an option of all of them
RENDERER = "tdpt-render"


@dataclass(frozen=True)
class Knob:
    """One option of one program; `values` from cheap to dear, as its command line has them. `flags`: it has no word of its
    own on the axis, so points are joined by no line."""

    program: str
    option: str
    values: tuple
    default: str
    unit: str = ""
    words: bool = False

    @property
    def name(self):
        return f"{self.program} {self.option}"

    def arguments(self, value):
        return (self.option, value)

    def settings(self, value):
        """{program: options}"""
        return {p: self.arguments(value) for p in (STAGES if self.program == CHAIN else (self.program,))}


KNOBS = (
    Knob(CHAIN, "--quality", ("draft", "normal", "high"), "normal"),
    Knob("ffgraph", "--walks", ("6250", "25000", "100000", "400000"), "100000", "walks"),
    Knob("ffgraph", "--samples", ("18750", "75000", "300000", "1200000"), "300000", "rays a round"),
    Knob("ffgraph", "--rounds", ("0", "1", "2", "3"), "1", "rounds"),
    Knob("ffgraph", "--cells", ("6", "12", "24", "48"), "24", "patches along the diagonal"),
    Knob("ffgraph", "--bounces", ("2", "4", "8", "12", "24"), "12", "surfaces of a walk"),
    Knob("ffgraph", "--nodes", ("triangles", "patches"), "patches", words=True),
    Knob("mincut", "--cuts", ("1", "2", "4", "8", "16"), "8", "bottlenecks looked for"),
    Knob("mincut", "--largest-conductance", ("0.03", "0.06", "0.12", "0.24"), "0.12", "share of the light"),
    Knob("lightgrid", "--resolution", ("32", "64", "128", "256"), "128", "voxels along the longest side"),
    Knob("lightgrid", "--lines", ("512", "2048", "4096", "8192", "16384", "32768"), "8192", "lines of light"),
    Knob("portalfit", "--threshold", ("0.005", "0.02", "0.05", "0.2"), "0.02", "share of the lines"),
    Knob("portalfit", "--max-portals", ("1", "2", "4", "8"), "8", "portals at most"),
    Knob("portalfit", "--method", ("paper", "tube"), "tube", words=True),
    Knob(RENDERER, "--guide-light", ("0", "0.25", "0.5", "0.7", "0.9"), "0.7", "probability"),
    Knob(RENDERER, "--guide-camera", ("0", "0.2", "0.4", "0.7", "0.9"), "0.4", "probability"),
    Knob(RENDERER, "--segments", ("0.0625", "0.125", "0.25", "0.5", "1"), "0.25", "share of the samples"),
    Knob(RENDERER, "--light-walks", ("0.0625", "0.125", "0.25", "0.5", "1"), "0.25", "share of the samples"),
    Knob(RENDERER, "--mis", ("balance", "power"), "balance", words=True),
)
DEPTHS = ("2", "3", "4", "6", "8", "12", "none")
INTEGRATORS = ("nee", "bdpt", "tdpt-org", "tdpt", "tdpt-guided", "auto")
WITHOUT_PORTALS = ("pt", "nee", "bdpt")
LENGTHS = (1, 2, 4, 8, 16, 32, 64)  # samples per pixel, of the samples that a scene's pictures have: LENGTHS / 8


@dataclass(frozen=True)
class Scene:
    """reference: of testdata/references/efficiency, which tells size and depth. apertures: the true ones, rectangles
    (corner, edge, edge) in metres whose normal, edge x edge, is the light's way; none where they are not known in figures:
    then the portal of the most accurate settings stands for them. aperture: whether there is any; where not, no portal is
    the right answer."""

    name: str
    apertures: tuple = ()
    paper: bool = False
    aperture: bool = True

    @property
    def openings(self):
        """How many there are; "" where that is not known in figures."""
        return len(self.apertures) if self.apertures or not self.aperture else ""


def hole(x, side):
    """A square in the wall about x, the light's way -x, as testdata/scenes/README.md has it."""
    h = side / 2
    return ((x, 1 - h, -h), (0, 0, side), (0, side, 0))


SCENES = (
    Scene("two-rooms", (hole(2.05, 0.25),)),
    Scene("small-hole", (hole(2.05, 0.1),)),
    Scene("three-rooms", (hole(2.05, 0.5), hole(4.15, 0.5))),
    Scene("half-metre-hole", (hole(2.05, 0.5),)),
    Scene("door-ajar"),
    Scene("cornell-box-portal", (((1.01, 0.75, -0.25), (0, 0, 0.5), (0, 0.5, 0)),), paper=True),
    Scene("veach-ajar", paper=True),
    Scene("bathroom2-channel", paper=True),
    Scene("living-room-lamps", aperture=False),
)
# Where portals are worth little or nothing: for the renderer's curves alone.
OPEN = (Scene("window", (((2.05, 0.2, -0.8), (0, 0, 1.6), (0, 1.6, 0)),)), Scene("kitchen", aperture=False),
        Scene("cornell-box", paper=True, aperture=False))
WHOLE = ("two-rooms-whole", "veach-ajar-whole", "kitchen-whole", "bathroom2-whole")

# Rooms whose openings are known (libcommon/testing/rooms/known_rooms.h) that score portals, one by one.
KINDS = ("slit", "hole", "ajar-full", "doors-in-row", "two-openings", "furnished-door", "shared-edge", "ajar", "keyhole",
         "sky-window", "deep-facade", "deep-room")

# Shares of the area that the smallest triangles make, dropped before the four stages.
SIMPLIFIED = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5)


def accurate(program):
    """Options of the portal that stands for an aperture that is not known in figures."""
    return {"ffgraph": ("--walks", "400000", "--samples", "1200000", "--rounds", "2"),
            "lightgrid": ("--lines", "32768", "--resolution", "256"), "mincut": (), "portalfit": ()}[program]
