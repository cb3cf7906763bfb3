"""Draws the fields of a run: bodies as deformed, coloured by a field. One frame as PNG, or all as GIF or MP4.

    python plots/render.py fields.xdmf picture.png --frame last --field von_mises
    python plots/render.py fields.xdmf film.gif --field velocity --fps 15
    python plots/render.py fields.xdmf --field contact_pressure --step 40 --cut y --output picture.png

Colours mean the same in all frames; grey is where there are no numbers. They end at the 99th percentile of the frame with the largest numbers, so
that the peak of one element does not leave a whole body dark; the scale says where there is more. No display is needed.
"""

import argparse
import ctypes.util
import os
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import h5py
import numpy as np
from figures import CannotDraw, time_scale
from figures import scale as unit_scale
from impakt_results import text
from PIL import Image

if not os.environ.get("DISPLAY") and ctypes.util.find_library("OSMesa"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")  # else vtk looks for an X server first, and complains

import pyvista

NAMES = {"von_mises": "von Mises stress", "contact_force": "contact force", "contact_pressure": "contact pressure", "contact_gap": "gap", "contact_active": "in contact", "rank": "rank", "body": "body"}
AXES = "xyz"
VIEWS = {"iso": ((-1, -1.5, 1), (0, 0, 1)), "xy": ((0, 0, 1), (0, 1, 0)), "xz": ((0, -1, 0), (0, 0, 1)), "yz": ((1, 0, 0), (0, 0, 1))}
PART = ((0.02, 0.82), (0.02, 0.91))  # of the picture, from left to right and from below, that the bodies fill; the rest is for scale and title
MOST_NAMES = 8  # of bodies, beside the scale
MOST_EDGES = 20_000  # cells with their edges drawn; in finer meshes there would be nothing but edges


class Fields:
    """Frames in the order of time, as the XDMF file lists them; numbers from the HDF5 file beside it."""

    def __init__(self, path):
        self.path = Path(path)
        if not self.path.is_file():
            raise CannotDraw(f"there is no file {path}")
        if self.path.suffix not in (".xdmf", ".xmf"):
            raise CannotDraw(f"{path}: give the .xdmf file beside it")
        try:
            grids = ElementTree.parse(self.path).getroot().findall("./Domain/Grid/Grid")
            self.times = [float(grid.find("Time").get("Value")) for grid in grids]
            self.on_cells = {item.get("Name") for item in grids[0].findall("Attribute") if item.get("Center") == "Cell"}
            self.datasets = [{item.get("Name"): item.find("DataItem").text.split(":")[1] for item in grid.findall("Attribute")} for grid in grids]
            where = grids[0].find("Geometry/DataItem").text.split(":")
            self.heavy = h5py.File(self.path.parent / where[0], "r")
            self.points = self.heavy[where[1]][()]
            self.time_unit = text(self.heavy["time"].attrs["units"])
            if "displacement" not in self.datasets[0]:
                raise KeyError("displacement")
        except (ElementTree.ParseError, AttributeError, IndexError, KeyError, ValueError) as error:
            raise CannotDraw(f"{path} is not the XDMF file of an Impakt run: {error}") from error
        except OSError as error:
            raise CannotDraw(f"the HDF5 file that {path} names cannot be read: {error}") from error
        self.reader = pyvista.get_reader(self.path)

    def __len__(self):
        return len(self.times)

    def data(self, name, frame):
        return self.heavy[self.datasets[frame][name]]

    def colours(self, field, frame):
        """The numbers of a field by which a frame is coloured."""
        name, component = field
        values = self.data(name, frame)[()]
        if component is not None:
            return values[:, component]
        return np.linalg.norm(values, axis=1) if values.ndim == 2 else values

    def field(self, word):
        """What is meant by von_mises, velocity (its magnitude), velocity_x, stress_xy, ..."""
        shapes = {name: self.heavy[where].shape for name, where in self.datasets[0].items()}
        known = {name: (name, None) for name, shape in shapes.items() if shape[1:] != (9,)}
        known |= {f"{name}_{a}": (name, i) for name, shape in shapes.items() if shape[1:] == (3,) for i, a in enumerate(AXES)}
        known |= {f"{name}_{a}{b}": (name, 3 * i + j) for name, shape in shapes.items() if shape[1:] == (9,) for i, a in enumerate(AXES) for j, b in enumerate(AXES)}
        if word not in known:
            raise CannotDraw(f"there is no field {word}; there are {', '.join(known)}")
        return known[word]

    def units(self, field):
        return text(self.data(field[0], 0).attrs.get("units", "1"))

    def limits(self, field, percentile):
        """Between which numbers of all frames colours change, but for not-a-numbers: the gap of nodes that are on no contact surface. So many percent
        of the numbers, by size, are within, in that frame which needs the widest colours; beyond are the peaks of a few elements."""
        whole = field[0] in ("rank", "body")
        found = [self.colours(field, frame) for frame in ([0] if whole else range(len(self)))]
        found = [values[~np.isnan(values)] for values in found]
        ends = [(values.min(), values.max()) for values in found if values.size]
        if not ends or not np.isfinite(ends).all():
            raise CannotDraw(f"{field[0]} has numbers that are not finite")
        low, high = float(min(low for low, _ in ends)), float(max(high for _, high in ends))
        if whole or percentile >= 100:
            return low, high
        sizes = [np.abs(values[values != 0]) for values in found]  # zeros are where nothing touches, and where no wave has come yet
        size = max((np.percentile(values, percentile) for values in sizes if values.size), default=0)
        return (max(low, -size), min(high, size)) if size > 0 else (low, high)

    def corners(self, factor, frames, axes):
        """Nodes that are outermost in some frame, along three axes and between any two of them."""
        ways = [a * first + b * other for i, first in enumerate(axes) for other in axes[i:] for a in (-1, 1) for b in (-1, 1)]
        found = []
        for frame in frames:
            points = self.points + factor * self.data("displacement", frame)[()]
            found.append(points[np.unique((points @ np.transpose(ways)).argmax(axis=0))])
        return np.concatenate(found)

    def bounds(self, factor, frames):
        """A box around all frames: xmin, xmax, ymin, ymax, zmin, zmax."""
        ends = [self.points + factor * self.data("displacement", frame)[()] for frame in frames]
        low, high = np.min([end.min(axis=0) for end in ends], axis=0), np.max([end.max(axis=0) for end in ends], axis=0)
        return np.column_stack((low, high)).ravel()

    def mesh(self, frame, factor, values, on_cells):
        """A frame's cells, deformed, with one number each or one for each node."""
        self.reader.set_active_time_value(self.reader.time_values[frame])
        mesh = self.reader.read()
        mesh.points = self.points + factor * mesh.point_data["displacement"]
        mesh.clear_data()
        (mesh.cell_data if on_cells else mesh.point_data)["colour"] = values
        return mesh


def cut_plane(words, bounds, view):
    """A point of the plane x, y or z = some number, and its normal, to the side that is cut off: where the camera is."""
    axis, _, number = words.partition("=")
    if axis not in tuple(AXES):
        raise CannotDraw(f"--cut {words}: give x, y or z, or a number with it, as in y=0.01")
    if flatness(bounds) < 3:
        raise CannotDraw(f"--cut {words}: only what has three dimensions can be cut")
    k = AXES.index(axis)
    point, normal = (bounds[::2] + bounds[1::2]) / 2, np.zeros(3)
    try:
        point[k] = float(number) if number else point[k]
    except ValueError:
        raise CannotDraw(f"--cut {words}: {number} is not a number") from None
    if not bounds[2 * k] < point[k] < bounds[2 * k + 1]:
        raise CannotDraw(f"--cut {words}: the bodies lie between {axis} = {bounds[2 * k]:.6g} and {bounds[2 * k + 1]:.6g}")
    normal[k] = 1 if VIEWS[view][0][k] > 0 else -1
    return point, normal


def flatness(bounds):
    """The number of directions in which there is something."""
    sizes = bounds[1::2] - bounds[::2]
    return int((sizes > 1e-6 * sizes.max()).sum())


def heading(words, time, times, unit):
    factor, unit = time_scale(times, unit)
    return f"{words + '    ' if words else ''}t = {factor * time:.4g} {unit}".rstrip()


def ribbon(line, width):
    """Bars along x as bands: wide lines leave gaps between them."""
    ends = line.cells.reshape(-1, 3)[:, 1:]
    n = line.n_points
    points = np.concatenate([line.points + (0, side * width / 2, 0) for side in (-1, 1)])
    band = pyvista.PolyData.from_regular_faces(points, np.column_stack((ends, ends[:, ::-1] + n)))
    for old, new, copies in ((line.cell_data, band.cell_data, 1), (line.point_data, band.point_data, 2)):
        for name in old:
            new[name] = np.tile(old[name], copies)
    return band


class Camera:
    """Draws frames, all from the same place, from which they fill the picture."""

    def __init__(self, fields, options, frames):
        self.fields, self.factor = fields, options.scale
        self.field = fields.field(options.field)
        self.frames = frames
        self.bounds = fields.bounds(options.scale, range(len(fields)))
        low, high = fields.limits(self.field, options.percentile)
        self.unit_factor, unit = unit_scale(max(abs(low), abs(high)), fields.units(self.field))
        if abs(low + high) < 1e-3 * (high - low):
            low = -high  # so that 0 is in the middle
        self.limits = np.array((low, high)) * self.unit_factor
        if low == high:
            self.limits = self.limits + np.array((-0.5, 0.5)) * max(1, abs(self.limits[0]))
        name, component = self.field
        self.label = NAMES.get(name, name) if component is None else options.field.replace("_", " ")
        self.label = self.label.replace(" ", "\n") + (f"\n[{unit}]" if unit not in ("", "1") else "")
        if name == "body":
            self.label += ":\n" + "\n".join(f"{i} {each}" for i, each in enumerate(fields.data(name, 0).attrs["names"].split(",")[:MOST_NAMES]))
        peak = max(np.abs(fields.limits(self.field, 100)))
        if peak > (1 + 1e-9) * max(abs(low), abs(high)):
            self.label += f"\npeak {peak * self.unit_factor:.3g}"
        self.title, self.size = options.title, options.size
        self.view = options.view or ("iso" if flatness(self.bounds) == 3 else "xy")
        self.cut = cut_plane(options.cut, self.bounds, self.view) if options.cut else None
        self.plotter = pyvista.Plotter(off_screen=True, window_size=options.size)
        self.plotter.set_background("white")
        self.text = int(max(8, min(options.size[1] / 45, options.size[0] / 60)))
        self.outline = None

    def place(self):
        """The bodies of the frames that are drawn fill their part of the picture; the scale is beside them."""
        toward, up = (np.array(vector) / np.linalg.norm(vector) for vector in VIEWS[self.view])
        right = np.cross(up, toward) / np.linalg.norm(np.cross(up, toward))
        up = np.cross(toward, right)
        camera = self.plotter.camera
        camera.parallel_projection = self.view != "iso"
        (left, end), (low, high) = PART
        reach = np.array((end - left, (high - low) * self.size[1] / self.size[0])) * self.size[0] / self.size[1]  # of a picture of height 1
        if self.outline is None:
            self.outline = self.fields.corners(self.factor, self.frames, (right, up, toward))
        centre, distance = self.outline.mean(axis=0), 10 * np.linalg.norm(np.ptp(self.outline, axis=0))
        slope = 2 * np.tan(np.radians(camera.view_angle) / 2)  # height of the picture by the distance
        for _ in range(50 if self.view == "iso" else 1):
            near = self.outline - centre
            seen = np.column_stack((near @ right, near @ up))
            if self.view == "iso":
                seen /= (distance - near @ toward)[:, None] * slope
            ends = np.array((seen.min(axis=0), seen.max(axis=0)))
            fill = (np.ptp(ends, axis=0) / reach).max()
            shift = ends.mean(axis=0) * (distance * slope if self.view == "iso" else 1)
            centre = centre + shift[0] * right + shift[1] * up
            distance *= fill if self.view == "iso" else 1
            distance = max(distance, 1.05 * ((self.outline - centre) @ toward).max())
        camera.position, camera.focal_point, camera.up = tuple(centre + distance * toward), tuple(centre), tuple(up)
        if self.view != "iso":
            camera.parallel_scale = fill / 2
        camera.SetWindowCenter(1 - left - end, 1 - low - high)
        self.plotter.renderer.ResetCameraClippingRange()

    def shoot(self, frame):
        """A picture of a frame: height, width, red-green-blue."""
        fields, plotter = self.fields, self.plotter
        values = fields.colours(self.field, frame) * self.unit_factor
        mesh = fields.mesh(frame, self.factor, values, self.field[0] in fields.on_cells)
        if not np.isfinite(mesh.points).all():
            raise CannotDraw(f"displacements of frame {frame} are not finite")
        flat = flatness(self.bounds) < 3
        lines = flatness(self.bounds) == 1
        if lines:
            mesh = ribbon(mesh, np.ptp(self.bounds[:2]) / 40)
        if self.cut:
            mesh = mesh.clip(origin=self.cut[0], normal=self.cut[1])
            if not mesh.n_cells:
                raise CannotDraw(f"--cut leaves nothing of frame {frame}")
        whole = self.field[0] in ("rank", "body")
        plotter.clear()
        plotter.add_mesh(
            mesh,
            scalars="colour",
            clim=self.limits,
            cmap="tab10" if whole else "viridis",
            n_colors=int(self.limits[1] - self.limits[0]) + 1 if whole else 256,
            show_edges=not lines and not self.cut and mesh.n_cells <= MOST_EDGES,
            edge_color="#333333",
            nan_color="#bbbbbb",
            lighting=not flat,
            scalar_bar_args={
                "title": self.label + "\n",  # the empty line keeps it off the numbers
                "vertical": True,
                "color": "black",
                "title_font_size": self.text + 2,
                "label_font_size": self.text,
                "fmt": "%.0f" if whole else "%.3g",
                "n_labels": min(5, int(self.limits[1] - self.limits[0]) + 1) if whole else 5,
                "position_x": PART[0][1] + 0.03,
                "position_y": 0.25,
                "width": 0.07,
                "height": 0.6,
            },
        )
        plotter.add_text(heading(self.title, fields.times[frame], fields.times, fields.time_unit), position="upper_left", font_size=self.text * 0.75, color="black")
        if not flat:
            plotter.add_axes(color="black", viewport=(PART[0][1] + 0.02, 0, 1, 0.22))
        self.place()
        return plotter.screenshot(return_img=True)


def chosen(frame, n):
    """The number of one frame, from 'last', '12', or '-1' as lists have it."""
    try:
        number = n - 1 if frame == "last" else int(frame)
    except ValueError:
        raise CannotDraw(f"--frame {frame}: give a number or 'last'") from None
    if not -n <= number < n:
        raise CannotDraw(f"there is no frame {number}: there are {n}, from 0 to {n - 1}")
    return number % n


def write_gif(path, pictures, fps):
    images = [Image.fromarray(picture).quantize(128, dither=Image.Dither.NONE) for picture in pictures]
    images[0].save(path, save_all=True, append_images=images[1:], duration=round(1000 / fps), loop=0)


def find_ffmpeg():
    if shutil.which("ffmpeg"):
        return "ffmpeg"
    try:
        import imageio_ffmpeg

        return imageio_ffmpeg.get_ffmpeg_exe()
    except (ImportError, RuntimeError):
        raise CannotDraw("MP4 needs ffmpeg, which is not here: install it, or give the name of a .gif") from None


def write_mp4(path, pictures, fps, size, ffmpeg):
    command = [ffmpeg, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "-"]
    command += ["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE) as process:
        for picture in pictures:
            process.stdin.write(picture.tobytes())
        process.stdin.close()
    if process.returncode:
        raise CannotDraw(f"ffmpeg could not write {path}")


def write(path, fields, options):
    kind = path.suffix.lower()
    if kind not in (".png", ".gif", ".mp4"):
        raise CannotDraw(f"{path}: give the name of a .png, .gif or .mp4")
    ffmpeg = find_ffmpeg() if kind == ".mp4" else None
    frames = [chosen(options.frame, len(fields))] if kind == ".png" else range(len(fields))
    camera = Camera(fields, options, frames)
    path.parent.mkdir(parents=True, exist_ok=True)
    if kind == ".png":
        Image.fromarray(camera.shoot(frames[0])).save(path)
        return
    pictures = (camera.shoot(frame) for frame in camera.frames)
    if kind == ".gif":
        write_gif(path, pictures, options.fps)
    else:
        write_mp4(path, pictures, options.fps, options.size, ffmpeg)


def size(text):
    width, height = (int(number) for number in text.split("x"))
    if not (16 <= width <= 10_000 and 16 <= height <= 10_000):
        raise ValueError
    return width, height


def percent(text):
    if not 0 < float(text) <= 100:
        raise ValueError
    return float(text)


def rate(text):
    if not 0 < float(text) <= 100:
        raise ValueError
    return float(text)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="plots/render.py", description="Draws the fields of a run, deformed and coloured.")
    parser.add_argument("fields", metavar="FILE.xdmf", help="what -output_fields has written")
    parser.add_argument("picture", metavar="OUT", type=Path, nargs="?", help="a .png of one frame; a .gif or .mp4 of all")
    parser.add_argument("--output", type=Path, metavar="OUT", help="the same, by name")
    parser.add_argument("--frame", "--step", default="last", help="of a .png: a number from 0, the initial state, or last (default)")
    parser.add_argument("--field", default="von_mises", help="von_mises (default), displacement, velocity, displacement_x, stress_xx, ..., contact_pressure, contact_gap, body, rank")
    parser.add_argument("--percentile", type=percent, default=99, metavar="P", help="colours up to the P-th percentile of the sizes of the numbers, default 99; 100: to the largest")
    parser.add_argument("--scale", type=float, default=1, help="factor for displacements, default 1")
    parser.add_argument("--view", choices=list(VIEWS), help="default iso, xy for bodies in one or two dimensions")
    parser.add_argument("--cut", metavar="AXIS[=X]", help="cut away what is before the plane x, y or z = X [m], default through the middle; solids only")
    parser.add_argument("--fps", type=rate, default=15, help="frames per second, default 15")
    parser.add_argument("--size", type=size, default=(1000, 700), metavar="WxH", help="in pixels, default 1000x700")
    parser.add_argument("--title", default="", help="words before the time")
    options = parser.parse_args(arguments)
    if (options.picture is None) == (options.output is None):
        parser.error("give the name of the picture, once")
    options.picture = options.picture or options.output
    return options


def main(arguments):
    options = parse(arguments)
    try:
        write(options.picture, Fields(options.fields), options)
    except (CannotDraw, OSError) as error:
        print(f"plots/render.py: {error}", file=sys.stderr)
        return 1
    print(options.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
