"""A second program on the display, through libX11 alone.

usage: x_client.py focus              opens a window, takes the keyboard, and keeps it until it is ended
       x_client.py close WINDOW       asks the window of that name to close, as its frame's button would
       x_client.py drop WINDOW FILE   drops a file onto it (XDND, version 5)
"""

import ctypes
import pathlib
import sys
import time

x = ctypes.CDLL("libX11.so.6")
P, L, I = ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int
x.XOpenDisplay.restype = P
x.XOpenDisplay.argtypes = [ctypes.c_char_p]
for name, result, arguments in [
    ("XDefaultRootWindow", L, [P]), ("XFlush", I, [P]), ("XSync", I, [P, I]), ("XPending", I, [P]),
    ("XInternAtom", L, [P, ctypes.c_char_p, I]), ("XMapWindow", I, [P, L]), ("XNextEvent", I, [P, P]),
    ("XCreateSimpleWindow", L, [P, L, I, I, I, I, I, L, L]), ("XSetInputFocus", I, [P, L, I, L]),
    ("XSetSelectionOwner", I, [P, L, L, L]), ("XSendEvent", I, [P, L, I, ctypes.c_long, P]),
    ("XChangeProperty", I, [P, L, L, L, I, I, ctypes.c_char_p, I]),
    ("XQueryTree", I, [P, L, P, P, P, P]), ("XFetchName", I, [P, L, P])]:
    getattr(x, name).restype, getattr(x, name).argtypes = result, arguments

display = x.XOpenDisplay(None) or sys.exit("no display")
root = x.XDefaultRootWindow(display)


def atom(name):
    return x.XInternAtom(display, name.encode(), 0)


class ClientMessage(ctypes.Structure):
    _fields_ = [("type", I), ("serial", L), ("send", I), ("display", P), ("window", L), ("message", L), ("format", I),
                ("data", ctypes.c_long * 5), ("rest", ctypes.c_long * 16)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [("type", I), ("serial", L), ("send", I), ("display", P), ("owner", L), ("requestor", L), ("selection", L),
                ("target", L), ("property", L), ("time", L), ("rest", ctypes.c_long * 16)]


class SelectionNotify(ctypes.Structure):
    _fields_ = [("type", I), ("serial", L), ("send", I), ("display", P), ("requestor", L), ("selection", L), ("target", L),
                ("property", L), ("time", L), ("rest", ctypes.c_long * 16)]


def named(name):
    parent, top, children, count = L(), L(), ctypes.POINTER(L)(), ctypes.c_uint()
    x.XQueryTree(display, root, *map(ctypes.byref, (top, parent, children, count)))
    for i in range(count.value):
        text = ctypes.c_char_p()
        if x.XFetchName(display, children[i], ctypes.byref(text)) and name in text.value.decode():
            return children[i]
    sys.exit(f"no window {name}")


def tell(window, message, *data):
    event = ClientMessage(type=33, window=window, message=atom(message), format=32)
    event.data[:len(data)] = data
    x.XSendEvent(display, window, 0, 0, ctypes.byref(event))
    x.XFlush(display)


def focus():
    window = x.XCreateSimpleWindow(display, root, 600, 400, 100, 100, 0, 0, 0)
    x.XMapWindow(display, window)
    x.XSync(display, 0)
    time.sleep(0.5)  # until it is shown: only then may it have the keyboard
    x.XSetInputFocus(display, window, 1, 0)
    x.XFlush(display)
    time.sleep(600)


def drop(name, file):
    target = named(name)
    source = x.XCreateSimpleWindow(display, root, 0, 0, 1, 1, 0, 0, 0)
    x.XSetSelectionOwner(display, atom("XdndSelection"), source, 0)
    tell(target, "XdndEnter", source, 5 << 24, atom("text/uri-list"), 0, 0)
    tell(target, "XdndPosition", source, 0, 100 << 16 | 100, 0, atom("XdndActionCopy"))
    end = time.time() + 60
    while time.time() < end:
        if not x.XPending(display):
            time.sleep(0.02)
            continue
        event = (ctypes.c_long * 24)()
        x.XNextEvent(display, ctypes.byref(event))
        kind = ctypes.cast(event, ctypes.POINTER(I))[0]
        if kind == 30:  # it asks what is dropped
            asked = ctypes.cast(event, ctypes.POINTER(SelectionRequest))[0]
            text = (pathlib.Path(file).absolute().as_uri() + "\r\n").encode()
            x.XChangeProperty(display, asked.requestor, asked.property, asked.target, 8, 0, text, len(text))
            answer = SelectionNotify(type=31, requestor=asked.requestor, selection=asked.selection, target=asked.target,
                                     property=asked.property, time=asked.time)
            x.XSendEvent(display, asked.requestor, 0, 0, ctypes.byref(answer))
            x.XFlush(display)
        elif kind == 33:
            message = ctypes.cast(event, ctypes.POINTER(ClientMessage))[0]
            if message.message == atom("XdndStatus"):
                if not message.data[1] & 1:
                    sys.exit("it takes nothing")
                tell(target, "XdndDrop", source, 0, 0, 0, 0)
            elif message.message == atom("XdndFinished"):
                return
    sys.exit("no answer")


if sys.argv[1] == "focus":
    focus()
elif sys.argv[1] == "close":
    tell(named(sys.argv[2]), "WM_PROTOCOLS", atom("WM_DELETE_WINDOW"), 0)
else:
    drop(sys.argv[2], sys.argv[3])
