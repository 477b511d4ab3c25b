"""The camera of a Blender scene in the options of tdpt. Axes there: +Y is up."""
import math

from .programs import Failure


def y_up(v):
    return (v[0], v[2], -v[1])


def sun(scene):
    """The suns' angle, of which tdpt has one for all."""
    angles = [o.data.angle for o in scene.objects if o.type == "LIGHT" and o.data.type == "SUN" and not o.hide_render]
    degrees = math.degrees(max(angles, default=0))
    return [f"--sun-angle={min(degrees, 90.0)!r}"] if degrees >= 0.01 else []


class Film:
    """The picture that tdpt renders and what Blender wants of it. tdpt's cameras have no shift: of a shifted one a wider
    picture is rendered, and cut."""

    def __init__(self, scene, camera):
        if not camera or camera.type != "CAMERA":
            raise Failure("The scene has no camera")
        if camera.data.type != "PERSP":
            raise Failure(f"Camera {camera.name} is {camera.data.type.lower()}: tdpt renders perspective cameras alone")
        render = scene.render
        if render.use_multiview:
            raise Failure("Stereo pictures are not rendered: switch Stereoscopy off")
        if abs(render.pixel_aspect_x / render.pixel_aspect_y - 1) > 1e-4:
            raise Failure("Pixels are not square: tdpt renders with an aspect of 1 : 1 alone")
        self.width = max(1, render.resolution_x * render.resolution_percentage // 100)
        self.height = max(1, render.resolution_y * render.resolution_percentage // 100)
        frame = camera.data.view_frame(scene=scene)
        depth = -frame[0].z
        xs, ys = [v.x / depth for v in frame], [v.y / depth for v in frame]
        self.left, self.right, self.bottom, self.top = min(xs), max(xs), min(ys), max(ys)
        self.step_x = (self.right - self.left) / self.width  # of a pixel, at distance 1
        self.step_y = (self.top - self.bottom) / self.height
        self.wide, self.cut_x = symmetric(self.left, self.right, self.step_x, self.width)
        self.high, self.cut_y = symmetric(-self.top, -self.bottom, self.step_y, self.height)
        self.camera = camera

    def options(self):
        """Where the camera is, and the picture's size."""
        matrix = self.camera.matrix_world
        eye = matrix.translation
        forward = -matrix.to_3x3().col[2].normalized()
        up = matrix.to_3x3().col[1].normalized()
        fov = 2 * math.degrees(math.atan(self.high * self.step_y / 2))
        words = []
        for name, vector in (("--look-from", eye), ("--look-at", eye + forward), ("--up", up)):
            words.append(f"{name}=" + ",".join(repr(c) for c in y_up(vector)))
        return [*words, f"--fov={fov!r}", f"--width={self.wide}", f"--height={self.high}"]

    def lens(self):
        """Depth of field; Blender's f-number is for its own film, tdpt's for one of 36 mm."""
        data = self.camera.data
        if not data.dof.use_dof:
            return []
        longer = max(self.wide * self.step_x, self.high * self.step_y)  # of the film, at distance 1
        film = data.lens * longer  # millimetres
        words = [f"--f-stop={data.dof.aperture_fstop * 36 / film!r}"]
        target = data.dof.focus_object
        distance = data.dof.focus_distance
        if target:
            matrix = self.camera.matrix_world
            distance = abs((target.matrix_world.translation - matrix.translation).dot(matrix.to_3x3().col[2].normalized()))
        return [*words, f"--focus={distance!r}"]


def symmetric(low, high, step, pixels):
    """(pixels of a film from -h to h that holds low..high, pixels cut before low), at most a quarter of a pixel off."""
    if abs(low + high) < 1e-6 * (high - low):
        return pixels, 0
    half = max(-low, high)
    wide = math.ceil(2 * half / step - 1e-6)
    choices = [(abs(before - round(before)), wide_, round(before)) for wide_ in (wide, wide + 1)
               for before in [(low + wide_ * step / 2) / step]]
    _, wide, before = min(choices)
    return max(wide, before + pixels), max(0, before)
