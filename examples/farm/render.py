"""Draws the frames of a scene on many workers, with Dask:

    python render.py SCENE.sdf --frames 0..240 -o frames/frame.png [--workers 3] [-- --size 1280x720 …]

What stands after -- goes to `surefoot render`. Frames are numbered as it numbers them.

Without --scheduler the workers are processes of this machine. With --scheduler tcp://HOST:8786 they are those of a cluster. They need the
program and nothing else: the scene's folder is sent to them, and the pictures are sent back. A piece that fails is tried again, and one
whose worker is lost goes to another. On one kind of adapter, or with `-- --device cpu`, the bytes are those of one machine alone.
"""

import argparse
import io
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tarfile
import tempfile

import dask

# A worker that is lost is no news: its work goes to another. This stands before what reads it.
dask.config.set({"logging.distributed": "critical"})
from distributed import Client, LocalCluster, as_completed

# So often a piece is begun before it is given up.
TRIES = 4


def packed(folder):
    """The files of a folder as one archive."""
    data = io.BytesIO()
    with tarfile.open(fileobj=data, mode="w:gz") as archive:
        archive.add(folder, arcname=".")
    return data.getvalue()


def draw(program, scene, files, first, end, options):
    """Draws the frames first..end of a scene in an empty folder. Gives back their names and bytes."""
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(files)) as archive:
            archive.extractall(folder, filter="data")
        out = pathlib.Path(folder, "drawn")
        out.mkdir()
        command = [program, "render", scene, "-o", str(out / "frame.png"), "--frames", f"{first}..{end}", *options]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"frames {first}..{end}: {done.stderr.strip()}")
        return [(path.name, path.read_bytes()) for path in sorted(out.iterdir())]


def lose_one(client):
    """Kills one of the workers, as a machine that is switched off."""
    address, process = next(iter(client.run(os.getpid).items()))
    os.kill(process, signal.SIGKILL)
    return address


def arguments():
    own, theirs = sys.argv[1:], []
    if "--" in own:
        at = own.index("--")
        own, theirs = own[:at], own[at + 1 :]
    reader = argparse.ArgumentParser(description=__doc__.split("\n")[0], usage="%(prog)s SCENE.sdf --frames 0..240 -o FRAME.png [-- options of `surefoot render`]")
    reader.add_argument("scene", type=pathlib.Path)
    reader.add_argument("-o", "--output", type=pathlib.Path, required=True, help="the name of the pictures, which are numbered")
    reader.add_argument("--frames", required=True, metavar="FIRST..END", help="without the last number")
    reader.add_argument("--piece", type=int, default=4, help="how many frames are drawn at once")
    reader.add_argument("--workers", type=int, default=os.cpu_count(), help="processes of this machine")
    reader.add_argument("--scheduler", help="the address of a cluster's scheduler instead")
    reader.add_argument("--program", default=shutil.which("surefoot") or "surefoot", help="the program, as workers find it")
    reader.add_argument("--lose-one", action="store_true", help="kill one worker of this machine after the first piece: to see that nothing is lost")
    args = reader.parse_args(own)
    try:
        first, end = map(int, args.frames.split(".."))
    except ValueError:
        reader.error(f"--frames {args.frames}: write them as 0..240")
    if not args.scene.is_file():
        reader.error(f"there is no file {args.scene}")
    if first >= end or args.piece < 1:
        reader.error("there is nothing to draw")
    if args.output.suffix != ".png":
        reader.error(f"pictures are written as PNG: write -o {args.output.with_suffix('.png')}")
    return args, first, end, theirs


def main():
    args, first, end, options = arguments()
    args.output.parent.mkdir(parents=True, exist_ok=True)
    cluster = None if args.scheduler else LocalCluster(n_workers=args.workers, threads_per_worker=1, dashboard_address=None)
    with Client(args.scheduler or cluster) as client:
        files = client.scatter(packed(args.scene.resolve().parent), broadcast=True)
        pieces = [(at, min(at + args.piece, end)) for at in range(first, end, args.piece)]
        work = [client.submit(draw, args.program, args.scene.name, files, *piece, options, retries=TRIES - 1) for piece in pieces]
        drawn, lost = 0, None
        for piece in as_completed(work):
            for name, picture in piece.result():
                # Whole or not at all.
                path = args.output.with_name(name.replace("frame", args.output.stem, 1))
                unfinished = path.with_suffix(".part")
                unfinished.write_bytes(picture)
                unfinished.replace(path)
                drawn += 1
            piece.release()
            print(f"\r{drawn} of {end - first} frames ", end="", file=sys.stderr, flush=True)
            if args.lose_one and lost is None:
                lost = lose_one(client)
                print(f"\n{lost} is killed", file=sys.stderr)
        print(file=sys.stderr)
    if cluster:
        cluster.close()
    return 0 if drawn == end - first else 1


if __name__ == "__main__":
    sys.exit(main())
