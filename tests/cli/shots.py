#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Shots that are disturbed: nothing is lost, nothing half-written, no picture wrong.

    shots.py signals HYPERFOCAL [COUNT [SEED]]    a signal, or two, at a random moment of a shot
    shots.py inputs HYPERFOCAL [COUNT [SEED]]     inputs that are replaced, overwritten, cut, grown or removed meanwhile

After each of COUNT (default 20) disturbed shots, OUTPUT's folder holds whole frames alone, and the same command again with
--resume makes exactly what an undisturbed shot makes of the inputs that are there.
"""
import os
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from exr import exr

FRAMES, VERSIONS = 8, 4
LOOK = ['--focus', '4', '--range', '2', '--engine', 'gather', '--max-radius', '4']
ENDING = {'TERM': signal.SIGTERM, 'INT': signal.SIGINT, 'HUP': signal.SIGHUP, 'KILL': signal.SIGKILL}


def picture(version, frame, width, height):
    """A file with R, G, B and Z."""
    r = random.Random(1000 * version + frame)
    channels = dict.fromkeys('RGB', lambda x, y: r.random())
    exr('made.exr', dict(channels, Z=lambda x, y: 1 + 8 * x / width), window=(0, 0, width - 1, height - 1))
    return read('made.exr')


def unstamped(data):
    """A written frame without what it says about its input's time: two hashes in its header."""
    for name in (b'hyperfocalHash\0', b'hyperfocalSum\0'):
        at = data.find(name)
        if at < 0:
            return data
        kind = data.index(b'\0', at + len(name)) + 1
        size = struct.unpack_from('<i', data, kind)[0]
        data = data[:kind + 4] + b'-' * size + data[kind + 4 + size:]
    return data


def read(path):
    with open(path, 'rb') as f:
        return f.read()


def write(path, data):
    with open(path, 'wb') as f:
        f.write(data)


class Shot:
    def __init__(self, program, seed):
        self.program, self.random, self.failed, self.cut_short = program, random.Random(seed), 0, 0
        self.pictures = [[picture(v, i, 96, 64 if v < VERSIONS - 1 else 48) for i in range(FRAMES)]
                         for v in range(VERSIONS)]
        os.mkdir('in')
        self.whole = []
        for version in self.pictures:
            for i, data in enumerate(version):
                write(f'in/f.{i + 1}.exr', data)
            self.run()
            self.whole.append([unstamped(read(f'out/f.{i + 1}.exr')) for i in range(FRAMES)])

    def begin(self):
        words = [self.program, 'in/f.#.exr', '-o', 'out/f.#.exr', '--resume', '--threads', str(self.random.randint(1, 4))]
        return subprocess.Popen(words + LOOK, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                start_new_session=True)

    def run(self):
        """An undisturbed shot into an empty folder. Returns its seconds."""
        shutil.rmtree('out', ignore_errors=True)
        os.mkdir('out')
        start, process = time.monotonic(), self.begin()
        said = process.communicate()[1]
        assert process.returncode == 0, said
        return time.monotonic() - start

    def bad(self, trial, what):
        print(f'FAILED trial {trial}: {what}')
        self.failed += 1

    def check(self, trial, expected, temporary):
        """Frames in OUTPUT's folder are whole: each is one of expected[number]. Other files only if temporary."""
        for name in sorted(os.listdir('out')):
            number = name[2:-4] if name.startswith('f.') and name.endswith('.exr') else ''
            if number.isdigit():
                if expected[int(number) - 1] and unstamped(read('out/' + name)) not in expected[int(number) - 1]:
                    self.bad(trial, f'{name} is none of the pictures that it may be')
            elif not temporary:
                self.bad(trial, f'{name} is left')

    def resume(self, trial, versions):
        """The command again makes what is missing, and all frames are those of the inputs that are there."""
        self.cut_short += any(not os.path.exists(f'out/f.{i + 1}.exr') for i in range(FRAMES))
        process = self.begin()
        said = process.communicate()[1]
        if process.returncode:
            self.bad(trial, f'exit code {process.returncode} when it is run again: {said.decode()}')
        for i, version in enumerate(versions):
            path = f'out/f.{i + 1}.exr'
            if not os.path.exists(path) or unstamped(read(path)) != self.whole[version][i]:
                self.bad(trial, f'{path} is not that of its input when it is run again')
        self.check(trial, [None] * FRAMES, temporary=False)

    def wait(self, trial, process):
        try:
            return process.communicate(timeout=60)[1].decode(errors='replace')
        except subprocess.TimeoutExpired:
            self.bad(trial, 'it does not end')
            process.kill()
            return process.communicate()[1].decode(errors='replace')


def signals(shot, count):
    for i, data in enumerate(shot.pictures[0]):
        write(f'in/f.{i + 1}.exr', data)
    takes = min(shot.run() for _ in range(3))
    for trial in range(count):
        r = shot.random
        for i in range(FRAMES):  # some frames are there already
            if r.random() < 0.8 and os.path.exists(f'out/f.{i + 1}.exr'):
                os.remove(f'out/f.{i + 1}.exr')
        process, sent = shot.begin(), []
        for _ in range(r.choice((1, 1, 2))):
            time.sleep(r.random() * takes)
            sent.append(r.choice(list(ENDING)))
            process.send_signal(ENDING[sent[-1]])
        said = shot.wait(trial, process)
        if process.returncode < 0 and -process.returncode not in [ENDING[s] for s in sent]:
            shot.bad(trial, f'{sent}: ended by signal {-process.returncode}: {said}')
        shot.check(trial, [[w] for w in shot.whole[0]], temporary='KILL' in sent)
        shot.resume(trial, [0] * FRAMES)


def disturb(shot, r, now):
    """Change one input in one of the ways in which files change. now[i]: its version, None if it is damaged or gone."""
    i, how = r.randrange(FRAMES), r.choice(('replace', 'overwrite', 'cut', 'grow', 'remove', 'touch'))
    path, version = f'in/f.{i + 1}.exr', r.randrange(VERSIONS)
    data = shot.pictures[version][i]
    if how == 'replace':
        write('in/new', data)
        os.rename('in/new', path)
        now[i] = version
    elif how == 'overwrite':
        with open(path, 'r+b' if os.path.exists(path) else 'wb') as f:
            half = r.randrange(len(data))
            f.write(data[:half])
            f.flush()
            time.sleep(r.random() * 0.01)
            f.write(data[half:])
            f.truncate()
        now[i] = version
    elif how == 'remove' and os.path.exists(path):
        os.remove(path)
        now[i] = None
    elif how == 'cut' and os.path.exists(path):
        os.truncate(path, r.randrange(len(data)))
        now[i] = None
    elif how == 'grow' and os.path.exists(path):
        with open(path, 'ab') as f:
            f.write(bytes(r.randrange(1, 2000)))
    elif how == 'touch' and os.path.exists(path):
        os.utime(path, (r.randrange(2 ** 31), r.randrange(2 ** 31)))
    return f'{how} {i + 1}'


def inputs(shot, count):
    takes = min(shot.run() for _ in range(3))
    for trial in range(count):
        r, now = shot.random, [0] * FRAMES
        for i in range(FRAMES):
            write(f'in/f.{i + 1}.exr', shot.pictures[0][i])
            if r.random() < 0.8 and os.path.exists(f'out/f.{i + 1}.exr'):
                os.remove(f'out/f.{i + 1}.exr')
        process, done = shot.begin(), []
        for _ in range(r.randint(1, 6)):
            time.sleep(r.random() * takes / 3)
            done.append(disturb(shot, r, now))
        said = shot.wait(trial, process)
        if process.returncode not in (0, 2, 3) or (process.returncode == 3 and 'failed' not in said):
            shot.bad(trial, f'{done}: exit code {process.returncode}: {said}')
        # A file that is overwritten in its place while it is read may show parts of both pictures.
        mixed = {int(d.split()[1]) - 1 for d in done if d.split()[0] in ('overwrite', 'cut', 'grow')}
        shot.check(trial, [None if i in mixed else [w[i] for w in shot.whole] for i in range(FRAMES)], temporary=False)
        gone = [i for i in range(FRAMES) if now[i] is None]
        for i in gone:
            write(f'in/f.{i + 1}.exr', shot.pictures[1][i])
            now[i] = 1
        shot.resume(trial, now)


def main():
    what, program = {'signals': signals, 'inputs': inputs}[sys.argv[1]], os.path.abspath(sys.argv[2])
    count, seed = int((sys.argv[3:] + ['20'])[0]), int((sys.argv[4:] + ['1'])[0])
    folder = tempfile.mkdtemp()
    try:
        os.chdir(folder)
        shot = Shot(program, seed)
        what(shot, count)
    finally:
        os.chdir('/')
        shutil.rmtree(folder)
    print(f'{count} disturbed shots from seed {seed}, {shot.cut_short} of them without all frames')
    if not shot.cut_short:
        shot.bad(count, 'no shot was cut short')
    print(f'{count - min(shot.failed, count)} passed, {shot.failed} failed')
    return shot.failed > 0


sys.exit(main())
