# import_damage.py - for tests of examples/tools/import.py: files damaged at random, and what the program makes of them in FOLDER, the first
# argument, with FOLDER/integrals.
import contextlib
import importlib
import io
import re
import resource
import signal
import subprocess
import sys

sys.path[:0] = ['examples/tools']
tool = importlib.import_module('import')
folder = sys.argv[1] + '/'
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
TOKENS = [b'nan', b'-1', b'1e400', b'0', b'99999999999', b'\xff\xfe', b',', b'\n', b'\0', b'"', b'%', b' ', b'inf', b'1e-320', b'2', b'-', b'*', b'\xe9', b'']


def damaged(data, draw):
    data = bytearray(data)
    for _ in range(draw.randint(1, 3)):
        at, n = draw.randrange(len(data) + 1), draw.choice((1, 1, 4, 8, 80, 800))
        how = draw.randrange(7)
        if how == 0 and at < len(data):
            data[at] ^= 1 << draw.randrange(8)
        elif how == 1:
            del data[at:at + n]
        elif how == 2:
            data[at:at] = data[at:at + n]
        elif how == 3:
            del data[at:len(data) if draw.random() < 0.3 else at + 1]
        elif how == 4:
            data[at:at] = draw.choice(TOKENS)
        elif how == 5:  # a number becomes another
            found = list(re.finditer(rb'[-+]?\d[\d.eE+-]*', bytes(data)))
            if found:
                span = draw.choice(found).span()
                data[span[0]:span[1]] = draw.choice(TOKENS)
        else:
            lines = bytes(data).split(b'\n')
            a, b = draw.randrange(len(lines)), draw.randrange(len(lines))
            lines[a], lines[b] = lines[b], lines[a]
            data = bytearray(b'\n'.join(lines))
    return bytes(data)


def late(*_):
    raise KeyboardInterrupt


def end_of(arguments, seconds):
    """How import.py ends within this time: read (by flexbeam, too), refused, or what is wrong; and what it says."""
    said = io.StringIO()
    signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        with contextlib.redirect_stderr(said), contextlib.redirect_stdout(said):
            status = tool.main(arguments + ['--out', folder + 'h.txt'])
    except SystemExit as end:
        status = end.code
    except BaseException as error:
        return '%s: %s' % (type(error).__name__, error), said.getvalue()
    finally:
        signal.alarm(0)
    if status == 0:
        done = subprocess.run([folder + 'integrals', folder + 'h.txt'], capture_output=True, text=True)
        return ('read', '') if done.returncode == 0 else ('a description that flexbeam does not read', said.getvalue() + done.stdout[-300:] + done.stderr)
    text = said.getvalue()
    named = re.search(r'import\.py: .*(\.(csv|mtx|npz|mat|op4|bdf|op2|pch|asm|matrix|inp)\b|node \d|mode \d|--\w)', text)
    understood = 'not understood' not in text
    return ('refused' if status == 1 and named and understood else 'a refusal without file, node or mode, or %s' % status, text)
